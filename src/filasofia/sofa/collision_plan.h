#pragma once

#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/physics/defs.h"

#include <string>
#include <vector>

namespace filasofia::sofaengine {

/// A collision model as its node in SOFA is made: checked, plain data of ours, made on any thread.
struct CollisionPlan {
    physics::CollisionDef def = {};
    geometry::TriangleMesh mesh = {}; ///< [m] a soft body's in the world at rest, a rigid body's in its element
    std::vector<int> nodes = {};      ///< the body's node of each vertex; empty if the mesh is embedded, or rigid
};

/// Throws an Error that begins with `object` if a model asks for what this engine lacks. `world`: the mesh at rest.
std::vector<CollisionPlan> planCollision(const physics::SoftBodyDef& def, const geometry::TetMesh& world,
                                         const std::string& object);
std::vector<CollisionPlan> planCollision(const physics::RigidBodyDef& def, const std::string& object);

} // namespace filasofia::sofaengine
