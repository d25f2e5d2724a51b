#pragma once

#include "filasofia/math/vec3.h"

#include <array>

namespace filasofia::engine {

/// An edge at the start and at the end of a step, in which its ends move along straight lines.
struct MovedEdge {
    std::array<Vec3, 2> from, to;
};

/// Whether two edges meet during the step, `near` [m] or less apart. Edges that stay parallel meet nowhere.
bool passesThrough(const MovedEdge& one, const MovedEdge& two, double near);

} // namespace filasofia::engine
