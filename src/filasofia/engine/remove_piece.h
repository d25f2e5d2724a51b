#pragma once

#include "filasofia/engine/topology.h"

namespace filasofia::engine {

/// Takes a piece that came loose out of the scene: nothing touches it, it is not drawn, blades do not find it and it
/// does not move. Its nodes keep their numbers, far away and held. What held it lets go. False where there is no such
/// piece, or nothing else of the body. The solver is to be made anew.
bool removePiece(int piece, BodyTopology& topology, SoftModel& model, SoftState& body, State& state);

} // namespace filasofia::engine
