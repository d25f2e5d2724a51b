#pragma once

#include "filasofia/sofa/collision_plan.h"
#include "filasofia/sofa/collision_surface.h"
#include "filasofia/sofa/contact_stage.h"

namespace filasofia::sofaengine {

/// Makes a node below a soft body's, with a surface that follows the body and SOFA's collision models on it. `tag`:
/// what all of them are of. The body's node is not initialised yet.
CollisionSurface addCollision(const CollisionPlan& plan, const ModelTag& tag, const ContactStage& contact,
                              SoftStates& body);
/// The same for a rigid body. `centre`: the centre of mass in an element's coordinates.
CollisionSurface addCollision(const CollisionPlan& plan, const ModelTag& tag, const ContactStage& contact,
                              RigidStates& body, Vec3 centre);

} // namespace filasofia::sofaengine
