#pragma once

#include "filasofia/engine/scene/scene.h"

namespace filasofia::engine {

/// Takes a piece that came loose out of the scene: it has no surface, blades do not find it and it does not move. Its
/// nodes keep their numbers and their places, held. What held it lets go. Collision meshes that ride on the body beside
/// its own surface keep what rides on the piece. False where there is no such piece, or nothing else of the body. The
/// body's system is outdated then.
bool removePiece(int piece, SoftBody& body, Scene& scene);

} // namespace filasofia::engine
