#pragma once

#include "filasofia/linalg/node_kernels.h"

#include <span>
#include <vector>

namespace filasofia::linalg {

/// Columns C of numbers, stored sixteen side by side: for C^T x, the products of all of them with one vector.
class ColumnPanels {
public:
    void clear() { assign({}, 0, 0); }
    /// `values`: column after column, each with as many numbers. Its first `rows` numbers count, zeros if it has fewer.
    /// `rows` must be a multiple of four.
    void assign(std::span<const float> values, std::size_t columns, std::size_t rows);
    /// Per column its product with x, which has as many numbers as there are rows; valid until the next call.
    std::span<const float> products(std::span<const float> x);

private:
    std::size_t columns_ = 0;
    std::vector<PanelRow> panels_;
    std::vector<float> products_;
};

} // namespace filasofia::linalg
