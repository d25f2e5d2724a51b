#pragma once

#include "filasofia/sofa/sofa_scene.h"

#include <memory>
#include <string>

namespace filasofia::sofaengine {

/// Whether an attachment needs constraints: one to a body, or one that may break. All others are pins.
bool isTie(const physics::AttachmentDef& def);

/// Ties nodes, or points of an element; false if there are none. Throws what SOFA throws.
bool addTie(AttachmentId id, BodyId body, const physics::AttachmentDef& def, SofaScene& scene);
bool addTie(AttachmentId id, BodyId body, const physics::RigidAttachmentDef& def, SofaScene& scene);
/// Ties a body to what it touched of another in the last step; false if that is nothing.
bool addTie(const physics::Grasp& grasp, SofaScene& scene);
/// Makes a tie, and couples the bodies that it holds. The scene has begun constraints. Throws what SOFA throws; then
/// nothing is coupled that was not.
std::unique_ptr<Tie> makeTie(const TieState& state, SofaScene& scene);

} // namespace filasofia::sofaengine
