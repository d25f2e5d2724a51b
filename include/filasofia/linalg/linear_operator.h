#pragma once

#include "filasofia/math/mat3.h"

#include <span>

namespace filasofia::linalg {

class BlockSparseMatrix;

/// A symmetric positive definite matrix over nodes with three unknowns each, as solvers see it. It may be assembled
/// (BlockSparseMatrix) or matrix-free; a matrix-free operator assembles its entries only if entries() is called.
class LinearOperator {
public:
    virtual ~LinearOperator() = default;
    [[nodiscard]] virtual int rows() const = 0; ///< nodes
    virtual void multiply(std::span<const Vec3> x,
                          std::span<Vec3> y) const = 0;                 ///< y = A x; y is written, not added to
    virtual void diagonal(std::span<Mat3> blocks) const = 0;            ///< the 3 x 3 blocks on the diagonal
    [[nodiscard]] virtual const BlockSparseMatrix& entries() const = 0; ///< for solvers that factorise
};

} // namespace filasofia::linalg
