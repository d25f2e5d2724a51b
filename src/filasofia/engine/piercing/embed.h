#pragma once

#include "filasofia/engine/body/attachment.h"
#include "filasofia/engine/body/soft_model.h"

#include <optional>
#include <vector>

namespace filasofia::engine {

/// The nodes and weights of a place [m] in tissue: those of the tetrahedron that holds it, as the tissue lies now. If
/// several do, it is one around `near`. None if the place is outside.
std::optional<std::vector<NodeWeight>> embed(Vec3 place, const std::vector<NodeWeight>& near, const SoftModel& tissue,
                                             const std::vector<Vec3>& x);

/// The same around `near`, but a place outside is moved into the element that it misses least.
std::optional<std::vector<NodeWeight>> embedNearest(Vec3 place, const std::vector<NodeWeight>& near,
                                                    const SoftModel& tissue, const std::vector<Vec3>& x);

} // namespace filasofia::engine
