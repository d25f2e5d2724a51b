#pragma once

#include "filasofia/engine/body/attachment.h"
#include "filasofia/engine/body/soft_model.h"

#include <optional>
#include <vector>

namespace filasofia::engine {

/// The nodes and weights of a place [m] in tissue: those of the tetrahedron that holds it, as the tissue lies now. The
/// search begins at the elements around `near` and goes two rings outwards. None if the place is in none of them.
std::optional<std::vector<NodeWeight>> embed(Vec3 place, const std::vector<NodeWeight>& near, const SoftModel& tissue,
                                             const std::vector<Vec3>& x);

/// The same, but a place outside is moved into the element that it misses least.
std::optional<std::vector<NodeWeight>> embedNearest(Vec3 place, const std::vector<NodeWeight>& near,
                                                    const SoftModel& tissue, const std::vector<Vec3>& x);

} // namespace filasofia::engine
