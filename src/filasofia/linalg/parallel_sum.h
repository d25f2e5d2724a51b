#pragma once

#include "filasofia/linalg/node_kernels.h"

#include <optional>

namespace filasofia::linalg {

/// The panels (multiplyPanels) of W = (H^-1 + B)^-1, the parallel sum of H and B^-1 (Anderson and Duffin 1969). B is
/// symmetric and positive definite, H is symmetric and may be singular; both have n rows of n numbers. W has as many
/// rows as a multiple of four. Nothing if B is not positive definite to rounding.
std::optional<std::vector<PanelRow>> parallelSum(std::span<const double> b, std::span<const double> h, int n);

} // namespace filasofia::linalg
