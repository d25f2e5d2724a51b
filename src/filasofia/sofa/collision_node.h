#pragma once

#include "filasofia/sofa/collision_models.h"
#include "filasofia/sofa/collision_plan.h"
#include "filasofia/sofa/contact_stage.h"
#include "filasofia/sofa/sofa_vec.h"

#include <sofa/component/statecontainer/MechanicalObject.h>

namespace filasofia::sofaengine {

using SoftStates = ::sofa::component::statecontainer::MechanicalObject<Vec3Types>;
using RigidStates = ::sofa::component::statecontainer::MechanicalObject<RigidTypes>;

/// Makes a node below a soft body's, with a surface that follows the body and SOFA's collision models on it. `tag`:
/// what all of them are of. The body's node is not initialised yet.
void addCollision(const CollisionPlan& plan, const ModelTag& tag, const ContactStage& contact, SoftStates& body);
/// The same for a rigid body. `centre`: the centre of mass in an element's coordinates.
void addCollision(const CollisionPlan& plan, const ModelTag& tag, const ContactStage& contact, RigidStates& body,
                  Vec3 centre);

} // namespace filasofia::sofaengine
