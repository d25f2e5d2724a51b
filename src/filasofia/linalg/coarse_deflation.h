#pragma once

#include "filasofia/linalg/coarse_level.h"
#include "filasofia/linalg/column_panels.h"

namespace filasofia::linalg {

/// Deflation columns of a coarse level (Nicolaides 1987): for a caller that knows of constraints on the body which are
/// not in its matrix, and corrects the coarse level for them.
///
///     F        columns over the nodes          B = R P A_c^-1 P^T R^T   the coarse level
///     F_c      P^T R^T F                       r_c                      residual on the coarse nodes
///     Y        A_c^-1 F_c                      x_c                      correction on the coarse nodes
///
/// Everything here is on the coarse nodes: F^T B F = F_c^T Y, F^T B r = Y^T r_c, and B (r - F a) adds to the nodes what
/// x_c - Y a does.
class CoarseDeflation {
public:
    void clear();
    /// Another column of F_c, zero, for the caller to add to. Valid until the next one is added.
    std::span<float> addColumn(std::size_t rows);
    /// Y, once all columns are there.
    void solve(const CoarseLevel& coarse);

    [[nodiscard]] int columns() const { return columns_; }
    [[nodiscard]] std::span<const float> solution(int column) const ///< a column of Y
    {
        const std::size_t entries = solutions_.size() / static_cast<std::size_t>(columns_);
        return std::span(solutions_).subspan(static_cast<std::size_t>(column) * entries, entries);
    }
    void products(int column, std::span<double> out);                     ///< per column: F^T B F, one row of it
    void project(std::span<const float> residual, std::span<double> out); ///< per column: Y^T r_c
    void subtract(std::span<const double> coefficients, std::span<float> correction) const; ///< x_c -= Y a

private:
    int columns_ = 0;
    std::vector<float> columnValues_, solutions_; ///< F_c and Y, column after column
    ColumnPanels panels_;                         ///< Y
};

} // namespace filasofia::linalg
