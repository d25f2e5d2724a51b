#include "filasofia/linalg/coarse_level.h"

#include "filasofia/core/worker_pool.h"

#include "linalg/preconditioner_problem.h"

namespace coarse_level_test {

using namespace filasofia;
using namespace filasofia::linalg;
using Problem = PreconditionerProblem;

TEST_CASE("a coarse level whose matrices are given is that of the matrix")
{
    std::mt19937 random(8);
    WorkerPool pool(1);
    const int unknowns = 50, coarseNodes = 9, pieces = 2;
    const Problem problem(random, 60, unknowns, coarseNodes, pieces);
    TwoLevelPreconditioner whole = rotatedPreconditioner(problem, random);
    const Eigen::MatrixXd p = denseInterpolation(problem);
    const Eigen::MatrixXd coarse = p.transpose() * denseMatrix(problem) * p;
    const auto rowsOf = [&](int first, int nodes) { // symmetric: column by column is row by row
        const Eigen::MatrixXd part = coarse.block(3 * first, 3 * first, 3 * nodes, 3 * nodes);
        return std::vector<double>(part.data(), part.data() + part.size());
    };
    const std::vector<double> lattice = rowsOf(0, coarseNodes);
    std::vector<double> small;
    for (int piece = 0; piece < pieces; ++piece) {
        const std::vector<double> rows = rowsOf(firstPieceNode(coarseNodes) + piece * kPieceNodes, kPieceNodes);
        small.insert(small.end(), rows.begin(), rows.end());
    }
    const Problem flat = problem.withoutCoarseLevel();
    TwoLevelPreconditioner m(flat.input());
    m.rotations() = whole.rotations();
    REQUIRE(m.takeCoarseLevel(CoarseLevel(CoarseInput{.matrix = lattice,
                                                      .pieces = small,
                                                      .freePieces = problem.freePieces,
                                                      .coarseNodes = coarseNodes,
                                                      .rows = problem.rows,
                                                      .corners = problem.corners,
                                                      .weights = problem.weights})));
    const NodeArray r = randomNodes(random, unknowns);
    NodeArray z(r.blocks()), expected(r.blocks());
    m.apply(r, z, pool);
    whole.apply(r, expected, pool);
    CHECK((dense(z, unknowns) - dense(expected, unknowns)).norm() <= 1e-5 * dense(expected, unknowns).norm());
}

TEST_CASE("a node follows the coarse nodes as it was last told to, and M^-1 stays symmetric")
{
    std::mt19937 random(6);
    WorkerPool pool(1);
    const Problem problem(random, 50, 40, 6);
    TwoLevelPreconditioner m = rotatedPreconditioner(problem, random);
    TwoLevelPreconditioner fresh = m;
    const Interpolation own = m.interpolation(3);
    m.interpolate(3, {.corners = {1, 1, 4, 0}, .weights = {0.5f, 0.5f, 0.25f, 0.0f}}); // one corner twice
    m.interpolate(3, own);
    m.interpolate(3, own);
    CHECK_FALSE(m.takeCoarseLevel(CoarseLevel{})); // one without coarse nodes
    CHECK(m.coarseNodes() == 6);
    const NodeArray a = randomNodes(random, 40), b = randomNodes(random, 40);
    NodeArray za(a.blocks()), zb(b.blocks()), fa(a.blocks());
    m.apply(a, za, pool);
    m.apply(b, zb, pool);
    fresh.apply(a, fa, pool);
    CHECK((dense(za, 40) - dense(fa, 40)).norm() <= 1e-6 * dense(fa, 40).norm());
    CHECK(std::abs(dense(a, 40).dot(dense(zb, 40)) - dense(b, 40).dot(dense(za, 40))) <=
          1e-6 * dense(a, 40).norm() * dense(zb, 40).norm());
    CHECK(m.takeCoarseLevel(CoarseLevel(problem.input(), blocksFor(40))));
}

} // namespace coarse_level_test
