#include "filasofia/linalg/column_panels.h"

#include <algorithm>

namespace filasofia::linalg {

void ColumnPanels::assign(std::span<const float> values, std::size_t columns, std::size_t rows)
{
    columns_ = columns;
    const auto panels = static_cast<std::size_t>(blocksFor(static_cast<int>(columns)));
    panels_.assign(panels * rows, {});
    products_.resize(panels * kBlock);
    const std::size_t stride = columns > 0 ? values.size() / columns : 0;
    for (std::size_t c = 0; c < columns; ++c)
        for (std::size_t k = 0; k < std::min(rows, stride); ++k)
            panels_[c / kBlock * rows + k].values[c % kBlock] = values[c * stride + k];
}

std::span<const float> ColumnPanels::products(std::span<const float> x)
{
    multiplyPanels(panels_, x, products_, 0, blocksFor(static_cast<int>(columns_)));
    return std::span(products_).first(columns_);
}

} // namespace filasofia::linalg
