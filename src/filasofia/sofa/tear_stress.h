#pragma once

#include "filasofia/math/mat3.h"
#include "filasofia/sofa/soft_node.h"

namespace filasofia::sofaengine {

/// [Pa] The least stress that tears an element of the body; infinite if none tears.
double tearingThreshold(const SoftPlan& plan);

/// The Cauchy stress of every element, by the law of its Def; springs have the virial stress. Where elements tear at
/// different stresses, each has its own in relation to the least. Empty if nothing is above the least. `held`: per
/// node, 1 if it does not move.
std::vector<Mat3> tearingStresses(const SoftPlan& plan, const std::vector<Vec3>& positions,
                                  const std::vector<std::uint8_t>& held);

/// The deformation gradient of an element.
Mat3 gradientOf(const SoftPlan& plan, std::size_t element, const std::vector<Vec3>& positions);

} // namespace filasofia::sofaengine
