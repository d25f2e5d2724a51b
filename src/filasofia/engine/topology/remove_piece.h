#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/physics/step.h"

namespace filasofia::engine {

/// Removes a piece that came loose from the scene: it has no surface, blades ignore it and it does not move. Its nodes
/// keep their numbers and are fixed at their places. Pins and attachments that hold it are released. Collision meshes
/// other than the body's own surface keep their points on the piece. Returns false if there is no such piece or nothing
/// else is left of the body. After a removal the body's system is outdated; the caller marks it.
bool removePiece(int piece, SoftBody& body, Scene& scene, physics::StepReport& report);

} // namespace filasofia::engine
