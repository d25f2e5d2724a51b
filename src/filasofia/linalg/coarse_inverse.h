#pragma once

#include "filasofia/linalg/node_kernels.h"
#include "filasofia/linalg/preconditioner_input.h"

#include <optional>

namespace filasofia::linalg {

/// The inverse of a coarse matrix, as the product with it reads it.
///
///     A_c = P^T A_rest P    the Galerkin matrix of the coarse level
struct CoarseInverse {
    std::vector<PanelRow> lattice; ///< without small pieces; coarseRows() rows per panel
    std::vector<PanelRow> pieces;  ///< kPieceRows rows per small piece, one piece after another
};

/// Rows of A_c^-1 as stored: three per coarse node, rounded up to a multiple of four.
constexpr int coarseRows(int coarseNodes) { return (3 * coarseNodes + 3) / 4 * 4; }

/// From the Galerkin product of a sparse matrix. Nothing if A_c is not positive definite to rounding: the smoother
/// alone is then the preconditioner.
std::optional<CoarseInverse> coarseInverse(const PreconditionerInput& in);
/// From A_c itself, in less than half of the operations. Its last bits differ from those of the other function, and
/// the motion of every body that was never cut depends on those.
std::optional<CoarseInverse> coarseInverse(const CoarseInput& in);

/// Writes the inverse of a matrix of kPieceUnknowns rows, whose lower half is read, as kPieceRows rows; zeros for the
/// unknowns that it lacks, whose diagonal is 0. Returns false, and writes nothing, if it is not positive definite to
/// rounding.
bool writePieceInverse(std::span<const double> matrix, std::span<PanelRow> out);

} // namespace filasofia::linalg
