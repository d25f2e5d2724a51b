#pragma once

#include "filasofia/math/vec3.h"

#include <span>
#include <string>

namespace filasofia::geometry {

/// What is odd about a surface that is to move with a tetrahedral mesh, as the end of a sentence for a warning; empty
/// if nothing is. It is odd if it reaches out of the box around the mesh by more than a tenth of its diagonal, or is
/// 200 times smaller: then one of them is in other units or at another place. Both in the same coordinates [m].
std::string oddFit(std::span<const Vec3> surface, std::span<const Vec3> mesh);

} // namespace filasofia::geometry
