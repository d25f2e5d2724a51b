#pragma once

#include "filasofia/engine/collision/surface_pair.h"

namespace filasofia::engine {

/// The points of one side that are inside the other side, which is closed, deeper than
/// findProximities() follows them: each with its nearest way out. After findProximities(), of a pair whose boxes meet.
void findDeepPoints(const Meeting& meeting, int source, std::vector<Proximity>& found);

} // namespace filasofia::engine
