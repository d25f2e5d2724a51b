#include "filasofia/linalg/matrix_free_cg.h"

#include "filasofia/core/worker_pool.h"
#include "filasofia/linalg/node_parts.h"

#include "linalg/random_matrix.h"

#include <cstring>
#include <numeric>

namespace matrix_free_cg_test {

using namespace filasofia;
using namespace filasofia::linalg;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::vector<Vec3> vectors(const NodeArray& nodes, int count)
{
    std::vector<Vec3> all;
    for (int i = 0; i < count; ++i) all.push_back(vectorOf(nodes[i]));
    return all;
}

void store(const std::vector<Vec3>& from, NodeArray& to)
{
    for (std::size_t node = 0; node < from.size(); ++node)
        for (int i = 0; i < 3; ++i) to[static_cast<int>(node)][i] = static_cast<float>(from[node][i]);
}

double product(const std::vector<Vec3>& a, const std::vector<Vec3>& b)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += dot(a[i], b[i]);
    return sum;
}

double size(const std::vector<Vec3>& a) { return std::sqrt(product(a, a)); }

double relativeDistance(const std::vector<Vec3>& a, const std::vector<Vec3>& b)
{
    std::vector<Vec3> difference;
    for (std::size_t i = 0; i < a.size(); ++i) difference.push_back(a[i] - b[i]);
    return size(difference) / size(b);
}

/// A random matrix and right-hand side, with a preconditioner and a solver.
struct Problem : NodeOperator {
    explicit Problem(std::mt19937& random, int nodes = 150)
        : count(nodes), matrix(randomSpd(random, nodes)), order(static_cast<std::size_t>(nodes)), q(order.size()),
          b(vectors(randomNodes(random, nodes), nodes))
    {
        std::iota(order.begin(), order.end(), 0);
        preconditioner = TwoLevelPreconditioner({.matrix = matrix, .rows = order, .corners = {}, .weights = {}});
        exact.resize(order.size());
        REQUIRE(makeCholesky()->solve(matrix, b, exact).converged);
    }

    double multiply(const NodeArray& p, NodeArray& out, WorkerPool&) override
    {
        ++products;
        const std::vector<Vec3> in = vectors(p, count);
        matrix.multiply(in, q);
        store(q, out);
        return product(in, vectors(out, count));
    }

    /// Solves from the first guess in x.
    NodeSolveReport solve(const SolveLimits& limits, int threads = 1)
    {
        WorkerPool pool(threads);
        products = 0;
        residual = NodeArray(blocksFor(count));
        store(b, residual);
        return cg.solve({*this, preconditioner, residual, product(b, b), mass}, x, limits, pool);
    }
    NodeSolveReport solveFrom(const std::vector<Vec3>& guess, const SolveLimits& limits)
    {
        x.setZero();
        store(guess, x);
        return solve(limits);
    }
    /// The square of the error in the norm of the matrix, which conjugate gradients reduce.
    double energyOfError()
    {
        std::vector<Vec3> error = vectors(x, count);
        for (std::size_t i = 0; i < error.size(); ++i) error[i] -= exact[i];
        matrix.multiply(error, q);
        return product(error, q);
    }
    std::vector<Vec3> scaled(double factor) const
    {
        std::vector<Vec3> all = exact;
        for (Vec3& each : all) each *= factor;
        return all;
    }

    int count, products = 0;
    double mass = 0.0;
    BlockSparseMatrix matrix;
    std::vector<int> order;
    std::vector<Vec3> q, b, exact;
    TwoLevelPreconditioner preconditioner;
    NodeArray residual, x{blocksFor(count), 1}; // one block of pinned nodes, which stays zero
    MatrixFreeCg cg{blocksFor(count), 1};
};

bool isFinite(const NodeArray& x)
{
    return std::all_of(x.data(), x.data() + 64 * (x.blocks() + x.pinnedBlocks()),
                       [](float each) { return std::isfinite(each); });
}

} // namespace

TEST_CASE("matrix-free conjugate gradients find the solution of Cholesky, to the rounding of floats")
{
    std::mt19937 random(1);
    for (const int nodes : {1, 2, 17, 150}) {
        Problem problem(random, nodes);
        const NodeSolveReport report = problem.solve({.tolerance = 1e-6});
        CHECK(report.converged);
        CHECK(!report.outOfTime);
        CHECK(report.residual <= 1e-6);
        CHECK(problem.products == report.iterations + 1);
        CHECK(relativeDistance(vectors(problem.x, nodes), problem.exact) < 1e-4); // condition numbers reach thousands
    }
}

TEST_CASE(
    "the returned residual is that of the solution, and the reported error is the one that the tolerance is about")
{
    std::mt19937 random(2);
    Problem problem(random);
    WorkerPool pool(1);
    const std::vector<Vec3> guess = randomVector(random, problem.count);
    for (const double tolerance : {0.5, 1e-1, 1e-3}) {
        const NodeSolveReport report = problem.solveFrom(guess, {.tolerance = tolerance});
        std::vector<Vec3> left = problem.b, ax(problem.b.size());
        problem.matrix.multiply(vectors(problem.x, problem.count), ax);
        for (std::size_t i = 0; i < left.size(); ++i) left[i] -= ax[i];
        const std::vector<Vec3> found = vectors(problem.residual, problem.count);
        for (std::size_t i = 0; i < left.size(); ++i) left[i] -= found[i];
        CHECK(size(left) < 1e-5 * size(problem.b)); // each iteration rounds

        // The error's energy as the preconditioner sees it, and the energy of the answer: b . x minus the error's
        // energy.
        NodeArray z(problem.residual.blocks());
        const double rz = problem.preconditioner.apply(problem.residual, z, pool);
        const double energy = product(problem.b, problem.exact) - problem.energyOfError();
        CHECK(report.residual == Approx(std::sqrt(rz / (rz + energy))).epsilon(1e-3)); // floats are summed
        CHECK(report.residual <= tolerance);
        CHECK(report.converged);
    }
}

TEST_CASE("errors of an answer too small to matter are relative to one that matters")
{
    std::mt19937 random(17);
    Problem problem(random);
    WorkerPool pool(1);
    problem.mass = problem.count;
    const double whole = product(problem.b, problem.exact); // energy of the answer
    const int iterations = problem.solveFrom({}, {.tolerance = 1e-3}).iterations;
    for (const double factor : {0.1, 10.0, 1e4}) {
        const double small = factor * std::sqrt(whole / problem.mass);
        const NodeSolveReport report = problem.solveFrom({}, {.tolerance = 1e-3, .smallAnswer = small});
        NodeArray z(problem.residual.blocks());
        const double rz = problem.preconditioner.apply(problem.residual, z, pool);
        const double energy = std::max(whole - problem.energyOfError(), problem.mass * small * small);
        CHECK(report.residual == Approx(std::sqrt(rz / (rz + energy))).epsilon(1e-3)); // floats are summed
        CHECK(report.converged);
        CHECK((factor < 1.0 ? report.iterations == iterations : report.iterations < iterations));
        CHECK((factor < 100.0 || report.iterations == 0));
    }
}

TEST_CASE("a good first guess saves iterations, and the answer itself needs none, however it is scaled")
{
    std::mt19937 random(3);
    Problem problem(random);
    const int fromZero = problem.solveFrom({}, {.tolerance = 1e-4}).iterations;
    std::vector<Vec3> near = problem.exact;
    for (std::size_t i = 0; i < near.size(); ++i) near[i] += 1e-3 * problem.b[i];
    CHECK(problem.solveFrom(near, {.tolerance = 1e-4}).iterations < fromZero);
    for (const double factor : {1.0, -1.0, 1e-8, -1e12}) { // also with the wrong sign, and huge
        const NodeSolveReport report = problem.solveFrom(problem.scaled(factor), {.tolerance = 1e-4});
        CHECK(report.converged);
        CHECK(report.iterations == 0);
        CHECK(relativeDistance(vectors(problem.x, problem.count), problem.exact) < 1e-4);
    }
}

TEST_CASE("no first guess leaves a larger error than zero does")
{
    std::mt19937 random(4);
    Problem problem(random);
    problem.solveFrom({}, {.maxIterations = 0});
    const double none = problem.energyOfError();
    const int fromZero = problem.solveFrom({}, {.tolerance = 1e-4}).iterations;
    for (int k = 0; k < 20; ++k) {
        std::vector<Vec3> guess = randomVector(random, problem.count);
        for (Vec3& each : guess) each *= std::pow(10.0, k - 8);
        problem.solveFrom(guess, {.maxIterations = 0});
        CHECK(problem.energyOfError() <= (1.0 + 1e-5) * none);
        const NodeSolveReport report = problem.solveFrom(guess, {.tolerance = 1e-4});
        CHECK(report.converged);
        CHECK(report.iterations <= fromZero + 3);
    }
}

TEST_CASE("a first guess that is too large for floats, or not a number, counts as zero")
{
    std::mt19937 random(5);
    Problem problem(random);
    const int fromZero = problem.solveFrom({}, {.tolerance = 1e-4}).iterations;
    const std::vector<Vec3> zero = vectors(problem.x, problem.count);
    for (const double bad : {3e38, kNaN, std::numeric_limits<double>::infinity()}) {
        INFO("the guess is " << bad);
        std::vector<Vec3> guess(static_cast<std::size_t>(problem.count), {bad, bad, -bad});
        guess[0] = {};
        const NodeSolveReport report = problem.solveFrom(guess, {.tolerance = 1e-4});
        CHECK(report.converged);
        CHECK(report.iterations == fromZero);
        CHECK(vectors(problem.x, problem.count) == zero);
    }
}

TEST_CASE("a right-hand side of zero gives zero, whatever the guess")
{
    std::mt19937 random(6);
    Problem problem(random);
    problem.b.assign(problem.b.size(), {});
    const NodeSolveReport report = problem.solveFrom(problem.exact, {});
    CHECK(report.converged);
    CHECK(report.residual == 0.0);
    CHECK(report.iterations == 0);
    CHECK(size(vectors(problem.x, problem.count)) == 0.0);
}

TEST_CASE("a right-hand side that is not finite ends the solve at once, with zero")
{
    std::mt19937 random(7);
    for (const double bad : {kNaN, std::numeric_limits<double>::infinity()}) {
        Problem problem(random);
        problem.b[10].y = bad;
        const NodeSolveReport report = problem.solveFrom(problem.exact, {});
        CHECK(!report.converged);
        CHECK(report.iterations == 0);
        CHECK(report.residual == 1.0);
        CHECK(problem.products == 0);
        CHECK(size(vectors(problem.x, problem.count)) == 0.0);
    }
}

TEST_CASE("a solve ends at its cap with the answer that it has")
{
    std::mt19937 random(8);
    Problem problem(random);
    problem.solveFrom({}, {.maxIterations = 0});
    double error = problem.energyOfError();
    for (const int cap : {1, 2, 5, 20}) {
        const NodeSolveReport report = problem.solveFrom({}, {.tolerance = 1e-6, .maxIterations = cap});
        CHECK(report.iterations == cap);
        CHECK(!report.converged);
        CHECK(!report.outOfTime);
        CHECK(problem.energyOfError() < error); // each iteration reduces it
        error = problem.energyOfError();
    }
}

TEST_CASE("a solve ends when time is out, which is asked between iterations once the minimum is done")
{
    std::mt19937 random(9);
    Problem problem(random);
    int asked = 0, yesAt = 1;
    SolveLimits limits{.tolerance = 1e-5, .minIterations = 4, .outOfTime = [&] { return ++asked == yesAt; }};
    NodeSolveReport report = problem.solveFrom({}, limits);
    CHECK(report.iterations == 4);
    CHECK(asked == 1);
    CHECK(report.outOfTime);
    CHECK(!report.converged);
    CHECK(report.residual < 1.0);

    asked = 0, yesAt = 3;
    report = problem.solveFrom({}, limits);
    CHECK(report.iterations == 6);
    CHECK(asked == 3);
    CHECK(report.outOfTime);

    asked = 0, yesAt = 0; // never
    report = problem.solveFrom({}, limits);
    CHECK(report.iterations > 6);
    CHECK(asked == report.iterations - 4);
    CHECK(!report.outOfTime);
    CHECK(report.converged);

    asked = 0, yesAt = 1;
    report = problem.solveFrom(problem.exact, {.minIterations = 0, .outOfTime = limits.outOfTime});
    CHECK(asked == 0); // the guess was good enough already
    CHECK(report.converged);
    CHECK(!report.outOfTime);
}

TEST_CASE("an indefinite matrix ends the solve with finite numbers, and is not called solved")
{
    std::mt19937 random(10);
    Problem problem(random);
    for (const int node : {3, 60, 149})
        problem.matrix.block(problem.matrix.find(node, node)) -= 50.0 * Mat3::identity();
    const NodeSolveReport report = problem.solveFrom({}, {.tolerance = 1e-5});
    CHECK(!report.converged);
    CHECK(report.iterations < 300);
    CHECK(std::isfinite(report.residual));
    CHECK(isFinite(problem.x));

    for (int at = 0; at < static_cast<int>(problem.matrix.columns().size()); ++at) problem.matrix.block(at) *= -1.0;
    problem.matrix.block(problem.matrix.find(0, 0)) = Mat3{};
    CHECK(!problem.solveFrom(problem.exact, {}).converged); // a guess without curvature counts as zero
    CHECK(isFinite(problem.x));
}

TEST_CASE("any number of threads gives the same bits of the solution")
{
    std::mt19937 random(11);
    Problem problem(random, 700); // three parts
    problem.solve({.tolerance = 1e-4});
    const NodeArray expected = problem.x;
    for (const int threads : {2, 3, 8}) {
        problem.x.setZero();
        problem.solve({.tolerance = 1e-4}, threads);
        CHECK(std::memcmp(problem.x.data(), expected.data(), 256 * static_cast<std::size_t>(expected.blocks())) == 0);
    }
}

} // namespace matrix_free_cg_test
