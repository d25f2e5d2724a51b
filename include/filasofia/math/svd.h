#pragma once

#include "filasofia/math/mat3.h"

namespace filasofia {

/// a = u diag(sigma) v^T with u and v rotations (determinant +1).
struct Svd {
    Mat3 u;
    Vec3 sigma; ///< sigma.x >= sigma.y >= |sigma.z|; sigma.z < 0 if det a < 0 (the convention of Irving et al. 2004)
    Mat3 v;
};

/// Singular values by one-sided Jacobi rotations (Hestenes 1958), which stay accurate for rank-deficient and inverted
/// matrices.
Svd svd(const Mat3& a);

} // namespace filasofia
