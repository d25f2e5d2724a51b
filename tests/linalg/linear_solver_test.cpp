#include "filasofia/linalg/linear_solver.h"

#include "linalg/random_matrix.h"

#include <limits>

namespace linear_solver_test {

using namespace filasofia;
using namespace filasofia::linalg;

namespace {

double relativeDistance(const std::vector<Vec3>& a, const std::vector<Vec3>& b)
{
    double error = 0.0, size = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        error += lengthSquared(a[i] - b[i]);
        size += lengthSquared(b[i]);
    }
    return std::sqrt(error / size);
}

} // namespace

TEST_CASE("both solvers find the x that made b")
{
    std::mt19937 random(6);
    const auto cholesky = makeCholesky(); // one solver for all sizes: it must detect a new pattern
    for (int n : {1, 2, 7, 40, 150}) {
        const BlockSparseMatrix a = randomSpd(random, n);
        const std::vector<Vec3> expected = randomVector(random, n);
        std::vector<Vec3> b(n);
        a.multiply(expected, b);

        std::vector<Vec3> x(n);
        const SolveReport direct = cholesky->solve(a, b, x);
        CHECK(direct.converged);
        CHECK(direct.residual < 1e-12);
        CHECK(relativeDistance(x, expected) < 1e-10);

        x.assign(n, {});
        const SolveReport iterative = makeConjugateGradient(10000, 1e-13)->solve(a, b, x);
        CHECK(iterative.converged);
        CHECK(relativeDistance(x, expected) < 1e-9);
    }
}

TEST_CASE("a Cholesky solver reuses its pattern for new values")
{
    std::mt19937 random(7);
    BlockSparseMatrix a = randomSpd(random, 20);
    const auto solver = makeCholesky();
    const std::vector<Vec3> b = randomVector(random, 20);
    std::vector<Vec3> x(20), half(20);
    solver->solve(a, b, x);
    for (int p = 0; p < static_cast<int>(a.columns().size()); ++p) a.block(p) *= 2.0;
    solver->solve(a, b, half);
    for (Vec3& v : half) v *= 2.0;
    CHECK(relativeDistance(half, x) < 1e-13);
}

TEST_CASE("conjugate gradients start from the guess and stop at the tolerance or the cap")
{
    std::mt19937 random(8);
    const BlockSparseMatrix a = randomSpd(random, 60);
    const std::vector<Vec3> b = randomVector(random, 60);
    std::vector<Vec3> x(60);
    const auto solver = makeConjugateGradient(1000, 1e-6);
    const SolveReport cold = solver->solve(a, b, x);
    CHECK(cold.converged);
    CHECK(cold.iterations > 3);
    CHECK(cold.residual <= 1e-6);
    CHECK(solver->solve(a, b, x).iterations == 0);

    x.assign(60, {});
    const SolveReport capped = makeConjugateGradient(2, 1e-6)->solve(a, b, x);
    CHECK(capped.iterations == 2);
    CHECK_FALSE(capped.converged);
    CHECK(capped.residual > 1e-6);
}

TEST_CASE("a right-hand side of zero gives zero")
{
    std::mt19937 random(9);
    const BlockSparseMatrix a = randomSpd(random, 10);
    const std::vector<Vec3> b(10);
    std::vector<Vec3> x = randomVector(random, 10); // a wrong guess
    CHECK(makeConjugateGradient(100, 1e-6)->solve(a, b, x).converged);
    CHECK(x == b);
}

TEST_CASE("a matrix that is not positive definite is reported, not thrown")
{
    BlockSparseMatrix a(std::vector<std::vector<int>>{{0}});
    a.block(0) = Mat3::diagonal({1, -1, 1});
    const std::vector<Vec3> b{{1, 1, 1}};
    std::vector<Vec3> x(1);
    x[0] = {5, 5, 5};
    CHECK_FALSE(makeCholesky()->solve(a, b, x).converged);
    CHECK(x[0] == Vec3{}); // the guess is not returned as an answer
    a.block(0) = Mat3::diagonal({std::numeric_limits<double>::quiet_NaN(), 1, 1});
    CHECK_FALSE(makeConjugateGradient(10, 1e-6)->solve(a, b, x).converged);
}

TEST_CASE("a right-hand side whose norm overflows gives no answer, and is reported")
{
    const BlockSparseMatrix a = [] {
        BlockSparseMatrix one(std::vector<std::vector<int>>{{0}});
        one.block(0) = Mat3::identity();
        return one;
    }();
    const std::vector<Vec3> b{{1e200, 0, 0}};
    std::vector<Vec3> x{{3, 3, 3}};
    const SolveReport report = makeConjugateGradient(10, 1e-6)->solve(a, b, x);
    CHECK_FALSE(report.converged);
    CHECK(std::isfinite(report.residual));
    CHECK(x[0] == Vec3{});
}

} // namespace linear_solver_test
