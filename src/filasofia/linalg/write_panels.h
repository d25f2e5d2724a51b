#pragma once

#include "filasofia/linalg/node_kernels.h"

#include <Eigen/Core>

namespace filasofia::linalg {

/// Writes a symmetric matrix, made even, as multiplyPanels() reads it: `rows` of each panel of sixteen columns.
inline void writePanels(const Eigen::MatrixXd& matrix, int rows, PanelRow* panels)
{
    for (Eigen::Index i = 0; i < matrix.rows(); ++i)
        for (Eigen::Index j = 0; j < matrix.cols(); ++j)
            panels[j / kBlock * rows + i].values[j % kBlock] = static_cast<float>(0.5 * (matrix(i, j) + matrix(j, i)));
}

} // namespace filasofia::linalg
