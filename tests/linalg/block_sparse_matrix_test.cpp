#include "linalg/random_matrix.h"

namespace block_sparse_matrix_test {

using namespace filasofia;
using namespace filasofia::linalg;

TEST_CASE("a block matrix finds its blocks and no others")
{
    BlockSparseMatrix a({{0, 2}, {1}, {0, 2}});
    CHECK(a.rows() == 3);
    CHECK(a.find(0, 0) == 0);
    CHECK(a.find(0, 2) == 1);
    CHECK(a.find(0, 1) == -1);
    CHECK(a.find(2, 2) == 4);
}

TEST_CASE("a block matrix times a vector equals the dense product")
{
    std::mt19937 random(5);
    const BlockSparseMatrix a = randomSpd(random, 12);
    const std::vector<Vec3> x = randomVector(random, 12);
    std::vector<Vec3> y(12);
    a.multiply(x, y);
    for (int r = 0; r < 12; ++r) {
        Vec3 expected;
        for (int c = 0; c < 12; ++c)
            if (const int p = a.find(r, c); p >= 0) expected += a.block(p) * x[c];
        CHECK(distance(y[r], expected) < 1e-14);
    }
    std::vector<Mat3> diagonal(12);
    a.diagonal(diagonal);
    for (int r = 0; r < 12; ++r) CHECK(diagonal[r] == a.block(a.find(r, r)));
}

} // namespace block_sparse_matrix_test
