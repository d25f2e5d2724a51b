#include "filasofia/linalg/coarse_deflation.h"

#include <algorithm>

namespace filasofia::linalg {

void CoarseDeflation::clear()
{
    columns_ = 0;
    columnValues_.clear();
    solutions_.clear();
    panels_.clear();
}

std::span<float> CoarseDeflation::addColumn(std::size_t rows)
{
    columnValues_.resize(columnValues_.size() + rows);
    ++columns_;
    return std::span(columnValues_).last(rows);
}

void CoarseDeflation::solve(const CoarseLevel& coarse)
{
    const std::size_t rows = coarse.residual().size(), entries = coarse.correction().size();
    const auto columns = static_cast<std::size_t>(columns_);
    solutions_.assign(columns * entries, 0.0f);
    coarse.solve(columnValues_, solutions_, columns);
    panels_.assign(solutions_, columns, rows);
}

void CoarseDeflation::products(int column, std::span<double> out)
{
    const std::size_t rows = columnValues_.size() / static_cast<std::size_t>(columns_);
    project(std::span(columnValues_).subspan(static_cast<std::size_t>(column) * rows, rows), out);
}

void CoarseDeflation::project(std::span<const float> residual, std::span<double> out)
{
    std::ranges::copy(panels_.products(residual).first(out.size()), out.begin());
}

void CoarseDeflation::subtract(std::span<const double> coefficients, std::span<float> correction) const
{
    const float* solution = solutions_.data();
    for (std::size_t c = 0; c < coefficients.size(); ++c, solution += correction.size())
        for (std::size_t k = 0; k < correction.size(); ++k)
            correction[k] -= static_cast<float>(coefficients[c]) * solution[k];
}

} // namespace filasofia::linalg
