#pragma once

#include "filasofia/geometry/triangle_mesh.h"
#include "filasofia/sofa/collision_models.h"
#include "filasofia/sofa/sofa_vec.h"

#include <sofa/component/statecontainer/MechanicalObject.h>

#include <vector>

namespace filasofia::sofaengine {

using SoftStates = ::sofa::component::statecontainer::MechanicalObject<Vec3Types>;
using RigidStates = ::sofa::component::statecontainer::MechanicalObject<RigidTypes>;

/// A surface that follows a body, with SOFA's collision models on it.
struct CollisionSurface {
    ModelTag tag = {};            ///< that of its models
    SoftStates::SPtr states = {}; ///< where its vertices are within a step
    std::vector<geometry::Triangle> triangles = {};
    double skin = 0.0; ///< [m] at this distance it begins to push
};

} // namespace filasofia::sofaengine
