#include "filasofia/linalg/two_level_preconditioner.h"

#include "filasofia/core/worker_pool.h"

#include "linalg/random_matrix.h"

#include <Eigen/Cholesky>

#include <cstring>
#include <numeric>
#include <optional>

using namespace filasofia;
using namespace filasofia::linalg;

namespace {

/// Without the blocks of rows and columns for which `same` does not hold.
template <class Same> BlockSparseMatrix uncoupled(const BlockSparseMatrix& all, const Same& same)
{
    std::vector<std::vector<int>> columns(static_cast<std::size_t>(all.rows()));
    for (int row = 0; row < all.rows(); ++row)
        for (int at = all.rowStarts()[row]; at < all.rowStarts()[row + 1]; ++at)
            if (same(row, all.columns()[at])) columns[static_cast<std::size_t>(row)].push_back(all.columns()[at]);
    BlockSparseMatrix matrix(columns);
    for (int row = 0; row < all.rows(); ++row)
        for (int column : columns[static_cast<std::size_t>(row)])
            matrix.block(matrix.find(row, column)) = all.block(all.find(row, column));
    return matrix;
}

/// A matrix of which some rows are unknowns, in an order of their own, and coarse nodes for its rows. The first
/// kPieceRows rows are a small piece, the next ones another, for as many as there are: nothing couples them.
struct Problem {
    static constexpr int kPieceRows = 6;
    Problem(std::mt19937& random, int matrixRows, int unknowns, int coarse, int smallPieces = 0)
        : pieces(smallPieces), matrix(randomSpd(random, matrixRows)), rows(static_cast<std::size_t>(matrixRows)),
          coarseNodes(coarse), corners(rows.size()), weights(rows.size())
    {
        std::iota(rows.begin(), rows.end(), 0);
        std::shuffle(rows.begin(), rows.end(), random);
        rows.resize(static_cast<std::size_t>(unknowns));
        for (std::size_t row = 0; row < corners.size() && coarse > 0; ++row)
            for (std::size_t k = 0; k < 4; ++k) {
                corners[row][k] = static_cast<int>(random() % static_cast<unsigned>(coarse));
                weights[row][k] = k == 3 ? 0.0f : randomFloat(random);
            }
        const auto pieceOf = [&](int row) { return std::min(row / kPieceRows, pieces); };
        matrix = uncoupled(matrix, [&](int row, int column) { return pieceOf(row) == pieceOf(column); });
        for (int row = 0; row < matrixRows && pieces > 0; ++row) {
            if (pieceOf(row) == pieces) continue;
            corners[row].fill(firstPieceNode(coarse) + pieceOf(row) * kPieceNodes + row % kPieceRows);
            weights[row] = {1.0f, 0.0f, 0.0f, 0.0f};
        }
    }
    [[nodiscard]] int allCoarseNodes() const
    {
        return pieces == 0 ? coarseNodes : firstPieceNode(coarseNodes) + pieces * kPieceNodes;
    }
    [[nodiscard]] PreconditionerInput input() const
    {
        return {.matrix = matrix,
                .rows = rows,
                .scale = 2.5,
                .coarseNodes = coarseNodes,
                .freePieces = freePieces,
                .corners = corners,
                .weights = weights};
    }

    int pieces;
    std::vector<char> freePieces = std::vector<char>(static_cast<std::size_t>(pieces), 1);
    BlockSparseMatrix matrix;
    std::vector<int> rows;
    int coarseNodes;
    std::vector<std::array<int, 4>> corners;
    std::vector<std::array<float, 4>> weights;
};

int count(const Problem& problem) { return static_cast<int>(problem.rows.size()); }

Eigen::VectorXd dense(const NodeArray& nodes, int unknowns)
{
    Eigen::VectorXd all(3 * unknowns);
    for (int i = 0; i < 3 * unknowns; ++i) all[i] = static_cast<double>(nodes[i / 3][i % 3]);
    return all;
}

Eigen::Matrix3d dense(const Mat3& m)
{
    return Eigen::Matrix3d{{m[0].x, m[0].y, m[0].z}, {m[1].x, m[1].y, m[1].z}, {m[2].x, m[2].y, m[2].z}};
}

/// R (D^-1 + P A_c^-1 P^T) R^T, with what is added to the diagonal of A_c: a part in a hundred thousand of itself, and
/// next to nothing of the largest entry, for coarse nodes that hold nothing.
Eigen::MatrixXd densePreconditioner(const Problem& problem, const std::vector<RotationBlock>& rotations)
{
    const int n = 3 * count(problem);
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n), inverseDiagonal = a, r = a;
    Eigen::MatrixXd p = Eigen::MatrixXd::Zero(n, 3 * problem.allCoarseNodes());
    for (int i = 0; i < count(problem); ++i) {
        const int row = problem.rows[static_cast<std::size_t>(i)];
        for (int j = 0; j < count(problem); ++j)
            if (const int at = problem.matrix.find(row, problem.rows[static_cast<std::size_t>(j)]); at >= 0)
                a.block<3, 3>(3 * i, 3 * j) = problem.input().scale * dense(problem.matrix.block(at));
        inverseDiagonal.block<3, 3>(3 * i, 3 * i) =
            Eigen::LLT<Eigen::Matrix3d>(a.block<3, 3>(3 * i, 3 * i)).solve(Eigen::Matrix3d::Identity());
        r.block<3, 3>(3 * i, 3 * i) = dense(rotationOf(rotations, i));
        for (std::size_t k = 0; k < 4 && problem.allCoarseNodes() > 0; ++k)
            p.block<3, 3>(3 * i, 3 * problem.corners[static_cast<std::size_t>(row)][k]) +=
                static_cast<double>(problem.weights[static_cast<std::size_t>(row)][k]) * Eigen::Matrix3d::Identity();
    }
    Eigen::MatrixXd sum = inverseDiagonal;
    if (problem.allCoarseNodes() > 0) {
        Eigen::MatrixXd coarse = p.transpose() * a * p;
        const double largest = coarse.diagonal().maxCoeff();
        if (largest == 0.0) return r * sum * r.transpose();
        for (Eigen::Index i = 0; i < coarse.rows(); ++i) coarse(i, i) += 1e-5 * coarse(i, i) + 1e-12 * largest;
        sum += p * Eigen::LLT<Eigen::MatrixXd>(coarse).solve(p.transpose());
    }
    return r * sum * r.transpose();
}

TwoLevelPreconditioner turned(const Problem& problem, std::mt19937& random)
{
    TwoLevelPreconditioner m(problem.input());
    m.rotations() = randomRotations(random, blocksFor(count(problem)));
    return m;
}

} // namespace

TEST_CASE("the preconditioner is its definition, with coarse nodes and without, of all rows or some of them")
{
    std::mt19937 random(1);
    WorkerPool pool(1);
    for (const int coarseNodes : {0, 1, 7})
        for (const int unknowns : {1, 16, 45, 60}) {
            INFO(coarseNodes << " coarse nodes, " << unknowns << " of 60 rows");
            const Problem problem(random, 60, unknowns, coarseNodes);
            TwoLevelPreconditioner m = turned(problem, random);
            CHECK(m.coarseNodes() == coarseNodes);
            const NodeArray r = randomNodes(random, unknowns);
            NodeArray z(r.blocks());
            const double rz = m.apply(r, z, pool);
            const Eigen::VectorXd exact = densePreconditioner(problem, m.rotations()) * dense(r, unknowns);
            const Eigen::VectorXd found = dense(z, unknowns);
            // Every entry of D^-1, P and A_c^-1 is rounded to float, 6e-8 of it, and a few hundred are summed up. With
            // fewer unknowns than coarse ones A_c is singular, and they cancel to a part in the hundred thousand.
            CHECK((found - exact).norm() <= (unknowns < coarseNodes ? 1e-2 : 1e-5) * exact.norm());
            CHECK(std::abs(rz - found.dot(dense(r, unknowns))) <= 1e-5 * found.norm() * dense(r, unknowns).norm());
            for (int node = unknowns; node < kBlock * r.blocks(); ++node) CHECK(vectorOf(z[node]) == Vec3{});
        }
}

TEST_CASE("small pieces are solved for exactly, beside the coarse nodes of the others or alone")
{
    std::mt19937 random(7);
    WorkerPool pool(2);
    const int unknowns = 50;
    for (const int coarseNodes : {0, 5, 16, 21})
        for (const int pieces : {1, 3}) {
            INFO(coarseNodes << " coarse nodes, " << pieces << " pieces");
            const Problem problem(random, 60, unknowns, coarseNodes, pieces);
            TwoLevelPreconditioner m = turned(problem, random);
            CHECK(m.coarseNodes() == problem.allCoarseNodes());
            const NodeArray r = randomNodes(random, unknowns);
            NodeArray z(r.blocks());
            const double rz = m.apply(r, z, pool);
            const Eigen::VectorXd exact = densePreconditioner(problem, m.rotations()) * dense(r, unknowns);
            CHECK((dense(z, unknowns) - exact).norm() <= 1e-5 * exact.norm());
            CHECK(std::abs(rz - exact.dot(dense(r, unknowns))) <= 1e-5 * exact.norm() * dense(r, unknowns).norm());
        }
}

TEST_CASE("a small piece that nothing holds moves rigidly in the coarse level")
{
    std::mt19937 random(9);
    WorkerPool pool(1);
    const int unknowns = 60, pieces = 2;
    const double massWeight = 1.25;
    Problem problem(random, 60, unknowns, 5, pieces), flat = problem;
    problem.freePieces[1] = 0; // stays what it is
    flat.coarseNodes = flat.pieces = 0;
    flat.freePieces.clear();
    TwoLevelPreconditioner m = turned(problem, random);
    const Eigen::MatrixXd before = densePreconditioner(problem, m.rotations());
    const Eigen::MatrixXd smoother = densePreconditioner(flat, m.rotations());
    const NodeArray x = randomNodes(random, unknowns), r = randomNodes(random, unknowns);
    std::vector<float> masses(static_cast<std::size_t>(unknowns));
    for (float& mass : masses) mass = 0.5f + std::abs(randomFloat(random));
    std::vector<int> slots; // of the piece
    for (int i = 0; i < unknowns; ++i)
        if (problem.rows[static_cast<std::size_t>(i)] < Problem::kPieceRows) slots.push_back(i);
    REQUIRE(slots.size() == Problem::kPieceRows);

    double mass = 0.0;
    Vec3 centre, force, torque;
    const auto massOf = [&](int slot) { return static_cast<double>(masses[static_cast<std::size_t>(slot)]); };
    for (int slot : slots) {
        mass += massOf(slot);
        centre += massOf(slot) * vectorOf(x[slot]);
        force += vectorOf(r[slot]);
    }
    centre = 1.0 / mass * centre;
    Mat3 inertia;
    for (int slot : slots) {
        const Vec3 arm = vectorOf(x[slot]) - centre;
        torque += cross(arm, vectorOf(r[slot]));
        inertia += massOf(slot) * (lengthSquared(arm) * Mat3::identity() - outer(arm, arm));
    }
    Eigen::VectorXd exact = before * dense(r, unknowns);
    const Eigen::VectorXd smooth = smoother * dense(r, unknowns);
    for (int slot : slots) {
        const Vec3 turned = cross(inverse(inertia) * torque, vectorOf(x[slot]) - centre);
        const Vec3 moved = 1.0 / massWeight * (1.0 / mass * force + turned);
        exact.segment<3>(3 * slot) = smooth.segment<3>(3 * slot) + Eigen::Vector3d(moved.x, moved.y, moved.z);
    }
    m.followPieces(x, masses, massWeight);
    NodeArray z(r.blocks());
    m.apply(r, z, pool);
    CHECK((dense(z, unknowns) - exact).norm() <= 1e-5 * exact.norm());
}

TEST_CASE("a coarse level whose matrices are given is that of the matrix")
{
    std::mt19937 random(8);
    WorkerPool pool(1);
    const int unknowns = 50, coarseNodes = 9, pieces = 2;
    const Problem problem(random, 60, unknowns, coarseNodes, pieces);
    TwoLevelPreconditioner whole = turned(problem, random);
    // P^T A P, taken from what the whole one is by definition
    Eigen::MatrixXd p = Eigen::MatrixXd::Zero(3 * unknowns, 3 * problem.allCoarseNodes()),
                    a(3 * unknowns, 3 * unknowns);
    a.setZero();
    for (int i = 0; i < unknowns; ++i) {
        const int row = problem.rows[static_cast<std::size_t>(i)];
        for (int j = 0; j < unknowns; ++j)
            if (const int at = problem.matrix.find(row, problem.rows[static_cast<std::size_t>(j)]); at >= 0)
                a.block<3, 3>(3 * i, 3 * j) = problem.input().scale * dense(problem.matrix.block(at));
        for (std::size_t k = 0; k < 4; ++k)
            p.block<3, 3>(3 * i, 3 * problem.corners[static_cast<std::size_t>(row)][k]) +=
                static_cast<double>(problem.weights[static_cast<std::size_t>(row)][k]) * Eigen::Matrix3d::Identity();
    }
    const Eigen::MatrixXd coarse = p.transpose() * a * p;
    const auto rowsOf = [&](int first, int nodes) { // symmetric: by columns is by rows
        const Eigen::MatrixXd part = coarse.block(3 * first, 3 * first, 3 * nodes, 3 * nodes);
        return std::vector<double>(part.data(), part.data() + part.size());
    };
    const std::vector<double> lattice = rowsOf(0, coarseNodes);
    std::vector<double> small;
    for (int piece = 0; piece < pieces; ++piece) {
        const std::vector<double> rows = rowsOf(firstPieceNode(coarseNodes) + piece * kPieceNodes, kPieceNodes);
        small.insert(small.end(), rows.begin(), rows.end());
    }
    PreconditionerInput flat = problem.input();
    flat.coarseNodes = 0;
    flat.freePieces = {};
    TwoLevelPreconditioner m(flat);
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

TEST_CASE("without rotations it is the preconditioner of the matrix at rest")
{
    std::mt19937 random(2);
    WorkerPool pool(1);
    const Problem problem(random, 30, 30, 5);
    TwoLevelPreconditioner m(problem.input());
    std::vector<RotationBlock> none(m.rotations().size());
    for (int node = 0; node < kBlock * static_cast<int>(none.size()); ++node) setRotation(none, node, {});
    const NodeArray r = randomNodes(random, 30);
    NodeArray z(r.blocks());
    m.apply(r, z, pool);
    const Eigen::VectorXd exact = densePreconditioner(problem, none) * dense(r, 30);
    CHECK((dense(z, 30) - exact).norm() <= 1e-5 * exact.norm());
}

TEST_CASE("the preconditioner is symmetric and positive")
{
    std::mt19937 random(3);
    WorkerPool pool(1);
    const Problem problem(random, 100, 90, 9);
    TwoLevelPreconditioner m = turned(problem, random);
    for (int k = 0; k < 20; ++k) {
        const NodeArray a = randomNodes(random, 90), b = randomNodes(random, 90);
        NodeArray za(a.blocks()), zb(b.blocks());
        CHECK(m.apply(a, za, pool) > 0.0);
        m.apply(b, zb, pool);
        const double ab = dense(a, 90).dot(dense(zb, 90)), ba = dense(b, 90).dot(dense(za, 90));
        CHECK(std::abs(ab - ba) <= 1e-6 * dense(a, 90).norm() * dense(zb, 90).norm());
    }
}

TEST_CASE(
    "coarse nodes that say the same twice, hold nothing, or are no use at all leave a finite positive preconditioner")
{
    std::mt19937 random(4);
    WorkerPool pool(1);
    Problem twins(random, 80, 70, 8), empty(random, 80, 70, 8), useless(random, 80, 70, 8);
    for (std::size_t row = 0; row < 80; ++row) {
        twins.corners[row] = {1, 5, 2, 3}; // the columns of coarse nodes 1 and 5 are one and the same
        twins.weights[row][1] = twins.weights[row][0];
        for (int& corner : empty.corners[row]) corner = std::max(corner, 3);
        useless.weights[row] = {};
    }
    for (const Problem* problem : {&twins, &empty, &useless}) {
        TwoLevelPreconditioner m = turned(*problem, random);
        CHECK(m.coarseNodes() == (problem == &useless ? 0 : 8));
        for (int k = 0; k < 10; ++k) {
            const NodeArray r = randomNodes(random, 70);
            NodeArray z(r.blocks());
            const double rz = m.apply(r, z, pool);
            CHECK(rz > 0.0);
            CHECK(std::isfinite(dense(z, 70).squaredNorm()));
            // Where A_c is singular, the two columns share what one of them would get: D^-1 and the rest are as ever.
            const Eigen::VectorXd exact = densePreconditioner(*problem, m.rotations()) * dense(r, 70);
            CHECK((dense(z, 70) - exact).norm() <= (problem == &twins ? 0.05 : 1e-5) * exact.norm());
        }
    }
}

TEST_CASE("any number of threads gives the same bits")
{
    std::mt19937 random(5);
    const Problem problem(random, 1500, 1400, 45); // six parts of nodes, three of coarse nodes and of panels
    TwoLevelPreconditioner m = turned(problem, random);
    const NodeArray r = randomNodes(random, 1400);
    std::optional<double> rz;
    NodeArray z(r.blocks());
    for (const int threads : {1, 2, 3, 8}) {
        WorkerPool pool(threads);
        for (int k = 0; k < 20; ++k) {
            NodeArray again(r.blocks());
            const double product = m.apply(r, again, pool);
            if (!rz) {
                rz = product;
                z = again;
            }
            REQUIRE(product == *rz);
            REQUIRE(std::memcmp(again.data(), z.data(), 256 * static_cast<std::size_t>(z.blocks())) == 0);
        }
    }
}

TEST_CASE("a node that is interpolated anew follows the coarse nodes as told last, and M^-1 stays symmetric")
{
    std::mt19937 random(6);
    WorkerPool pool(1);
    const Problem problem(random, 50, 40, 6);
    TwoLevelPreconditioner m = turned(problem, random);
    const TwoLevelPreconditioner fresh = m;
    const Interpolation own = m.interpolation(3);
    m.interpolate(3, {.corners = {1, 1, 4, 0}, .weights = {0.5f, 0.5f, 0.25f, 0.0f}}); // one corner twice
    m.interpolate(3, own);
    m.interpolate(3, own);
    CHECK_FALSE(m.takeCoarseLevel(CoarseLevel{})); // one without a coarse level
    CHECK(m.coarseNodes() == 6);
    TwoLevelPreconditioner as = fresh;
    const NodeArray a = randomNodes(random, 40), b = randomNodes(random, 40);
    NodeArray za(a.blocks()), zb(b.blocks()), fa(a.blocks());
    m.apply(a, za, pool);
    m.apply(b, zb, pool);
    as.apply(a, fa, pool);
    CHECK((dense(za, 40) - dense(fa, 40)).norm() <= 1e-6 * dense(fa, 40).norm());
    CHECK(std::abs(dense(a, 40).dot(dense(zb, 40)) - dense(b, 40).dot(dense(za, 40))) <=
          1e-6 * dense(a, 40).norm() * dense(zb, 40).norm());
    CHECK(m.takeCoarseLevel(CoarseLevel(problem.input(), blocksFor(40))));
}

TEST_CASE("pulls are weighed by the coarse level's answers, and taken from what it spreads")
{
    std::mt19937 random(6);
    WorkerPool pool(2);
    const int unknowns = 45, pulls = 19; // more than go side by side
    const Problem problem(random, 60, unknowns, 7, 2);
    Problem flat = problem;
    flat.coarseNodes = flat.pieces = 0;
    flat.freePieces.clear();
    TwoLevelPreconditioner m = turned(problem, random);
    const Eigen::MatrixXd whole = densePreconditioner(problem, m.rotations());
    const Eigen::MatrixXd coarse = whole - densePreconditioner(flat, m.rotations());
    for (int again = 0; again < 2; ++again) { // the second time after another lot was cleared
        Eigen::MatrixXd f = Eigen::MatrixXd::Zero(3 * unknowns, pulls);
        m.clearColumns();
        for (int p = 0; p < pulls; ++p) {
            std::vector<ColumnEntry> pull;
            for (int k = 0; k < 4; ++k) {
                int node = static_cast<int>(random() % unknowns);
                while ((p == 7 || p == 8 || p == pulls - 1) &&
                       problem.rows[static_cast<std::size_t>(node)] >= Problem::kPieceRows)
                    node = static_cast<int>(random() % unknowns); // at a small piece, and nothing else
                const Vec3 at{randomFloat(random), randomFloat(random), randomFloat(random)};
                pull.push_back({node, at});
                f.block<3, 1>(3 * node, p) += Eigen::Vector3d(at.x, at.y, at.z);
            }
            m.addColumn(pull);
        }
        m.finishColumns();
        const Eigen::MatrixXd answers = f.transpose() * coarse * f;
        std::vector<double> found(pulls), shares(pulls);
        for (int p = 0; p < pulls; ++p) {
            m.products(p, found);
            for (int q = 0; q < pulls; ++q)
                CHECK(std::abs(found[static_cast<std::size_t>(q)] - answers(p, q)) <= 1e-5 * answers.norm());
        }
        const NodeArray r = randomNodes(random, unknowns);
        NodeArray z(r.blocks());
        m.smooth(r, pool);
        m.project(found, pool);
        const Eigen::VectorXd weighed = f.transpose() * coarse * dense(r, unknowns);
        for (int p = 0; p < pulls; ++p)
            CHECK(std::abs(found[static_cast<std::size_t>(p)] - weighed[p]) <= 1e-5 * weighed.norm());
        for (double& share : shares) share = randomFloat(random);
        m.applyCoarse(r, z, pool, shares);
        const Eigen::VectorXd exact =
            whole * dense(r, unknowns) - coarse * f * Eigen::Map<Eigen::VectorXd>(shares.data(), pulls);
        CHECK((dense(z, unknowns) - exact).norm() <= 1e-5 * exact.norm());
    }
}
