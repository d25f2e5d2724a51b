#include "filasofia/linalg/two_level_preconditioner.h"

#include "filasofia/core/worker_pool.h"

#include "linalg/preconditioner_problem.h"

#include <cstring>
#include <optional>

namespace two_level_preconditioner_test {

using namespace filasofia;
using namespace filasofia::linalg;
using Problem = PreconditionerProblem;

TEST_CASE("the preconditioner is its definition, with coarse nodes and without, of all rows or some of them")
{
    std::mt19937 random(1);
    WorkerPool pool(1);
    for (const int coarseNodes : {0, 1, 7})
        for (const int unknowns : {1, 16, 45, 60}) {
            INFO(coarseNodes << " coarse nodes, " << unknowns << " of 60 rows");
            const Problem problem(random, 60, unknowns, coarseNodes);
            TwoLevelPreconditioner m = rotatedPreconditioner(problem, random);
            CHECK(m.coarseNodes() == coarseNodes);
            const NodeArray r = randomNodes(random, unknowns);
            NodeArray z(r.blocks());
            const double rz = m.apply(r, z, pool);
            const Eigen::VectorXd exact = densePreconditioner(problem, m.rotations()) * dense(r, unknowns);
            const Eigen::VectorXd found = dense(z, unknowns);
            // Every entry of D^-1, P and A_c^-1 is rounded to float, with a relative error of 6e-8, and a few hundred
            // are summed. If there are fewer unknowns than coarse nodes, A_c is singular, and they cancel to 1e-5.
            CHECK((found - exact).norm() <= (unknowns < coarseNodes ? 1e-2 : 1e-5) * exact.norm());
            CHECK(std::abs(rz - found.dot(dense(r, unknowns))) <= 1e-5 * found.norm() * dense(r, unknowns).norm());
            for (int node = unknowns; node < kBlock * r.blocks(); ++node) CHECK(vectorOf(z[node]) == Vec3{});
        }
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
    TwoLevelPreconditioner m = rotatedPreconditioner(problem, random);
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
    "coarse nodes that are the same twice, carry nothing, or have no weight leave a finite positive preconditioner")
{
    std::mt19937 random(4);
    WorkerPool pool(1);
    Problem twins(random, 80, 70, 8), empty(random, 80, 70, 8), useless(random, 80, 70, 8);
    for (std::size_t row = 0; row < 80; ++row) {
        twins.corners[row] = {1, 5, 2, 3}; // the columns of coarse nodes 1 and 5 are equal
        twins.weights[row][1] = twins.weights[row][0];
        for (int& corner : empty.corners[row]) corner = std::max(corner, 3);
        useless.weights[row] = {};
    }
    for (const Problem* problem : {&twins, &empty, &useless}) {
        TwoLevelPreconditioner m = rotatedPreconditioner(*problem, random);
        CHECK(m.coarseNodes() == (problem == &useless ? 0 : 8));
        for (int k = 0; k < 10; ++k) {
            const NodeArray r = randomNodes(random, 70);
            NodeArray z(r.blocks());
            const double rz = m.apply(r, z, pool);
            CHECK(rz > 0.0);
            CHECK(std::isfinite(dense(z, 70).squaredNorm()));
            // If A_c is singular, the two equal columns share what one of them would get; the rest is not affected.
            const Eigen::VectorXd exact = densePreconditioner(*problem, m.rotations()) * dense(r, 70);
            CHECK((dense(z, 70) - exact).norm() <= (problem == &twins ? 0.05 : 1e-5) * exact.norm());
        }
    }
}

/// M P C^-1 P^T r, with equal weights for each component.
Eigen::VectorXd denseCarried(const Problem& problem, const std::vector<float>& masses, const Eigen::VectorXd& r)
{
    const Eigen::MatrixXd p = denseInterpolation(problem);
    Eigen::VectorXd m(r.size());
    for (Eigen::Index i = 0; i < m.size(); ++i) m[i] = static_cast<double>(masses[static_cast<std::size_t>(i / 3)]);
    const Eigen::VectorXd c = p.transpose() * m;
    return m.cwiseProduct(p * (p.transpose() * r).cwiseQuotient(c));
}

TEST_CASE("coarse nodes carry impulses by their definition, and with their total, also after an edit")
{
    std::mt19937 random(6);
    WorkerPool pool(1);
    Problem problem(random, 300, 280, 9);
    for (std::array<float, 4>& weights : problem.weights) weights = {0.5f, 0.375f, 0.125f, 0.0f};
    TwoLevelPreconditioner m = rotatedPreconditioner(problem, random);
    const NodeArray r = randomNodes(random, 280);
    NodeArray carried(r.blocks());
    std::vector<float> masses(static_cast<std::size_t>(r.blocks()) * kBlock, 1.0f);
    for (const bool edited : {false, true}) {
        if (edited) {
            const Interpolation how{{1, 2, 3, 4}, {0.25f, 0.25f, 0.25f, 0.25f}};
            m.interpolate(17, how);
            problem.corners[static_cast<std::size_t>(problem.rows[17])] = how.corners;
            problem.weights[static_cast<std::size_t>(problem.rows[17])] = how.weights;
        }
        for (int node = 0; node < 280; ++node) {
            masses[static_cast<std::size_t>(node)] = 1.0f + 0.5f * randomFloat(random);
            m.setDiagonal(node, Mat3::identity()); // says that the mass may have changed
        }
        m.carry(masses, r, carried, pool);
        const Eigen::VectorXd found = dense(carried, 280), exact = denseCarried(problem, masses, dense(r, 280));
        CHECK((found - exact).norm() <= 1e-5 * exact.norm());
        for (Eigen::Index k = 0; k < 3; ++k) {
            double lost = 0.0;
            for (Eigen::Index i = k; i < found.size(); i += 3) lost += dense(r, 280)[i] - found[i];
            CHECK(std::abs(lost) <= 1e-5 * dense(r, 280).norm());
        }
        for (int node = 280; node < kBlock * r.blocks(); ++node) CHECK(vectorOf(carried[node]) == Vec3{});
    }
}

TEST_CASE("with present blocks it is their inverse alone, whole and in halves, until those of rest are used again")
{
    std::mt19937 random(8);
    WorkerPool pool(1);
    const Problem problem(random, 60, 45, 7);
    TwoLevelPreconditioner m = rotatedPreconditioner(problem, random);
    const NodeArray r = randomNodes(random, 45);
    NodeArray atRest(r.blocks()), z(r.blocks()), again(r.blocks());
    m.apply(r, atRest, pool);
    std::vector<Mat3> blocks;
    Eigen::VectorXd exact(3 * 45);
    for (int node = 0; node < 45; ++node) {
        const auto some = [&] { return Vec3{randomFloat(random), randomFloat(random), randomFloat(random)}; };
        const Vec3 a = some(), b = some();
        blocks.push_back(Mat3::identity() + outer(a, a) + outer(b, b));
        const Vec3 answer = inverse(blocks.back()) * vectorOf(r[node]);
        for (int k = 0; k < 3; ++k) exact[3 * node + k] = answer[k];
    }
    m.usePresent(blocks);
    m.apply(r, z, pool);
    CHECK((dense(z, 45) - exact).norm() <= 1e-5 * exact.norm());
    for (int node = 0; node < 45; ++node) {
        const Mat3 error = m.inverseDiagonal(node) - inverse(blocks[static_cast<std::size_t>(node)]);
        for (int k = 0; k < 3; ++k) CHECK(length(error[k]) < 1e-5);
    }
    m.smooth(r, pool);
    const std::vector<ColumnEntry> column{{3, {1.0, 2.0, 3.0}}};
    m.addColumn(column);
    m.finishColumns();
    for (const float each : m.coarseAnswer(pool)) CHECK(each == 0.0f);
    for (const float each : m.columnAnswer(0)) CHECK(each == 0.0f);
    const std::vector<double> share{2.0};
    m.applyCoarse(r, again, pool, share);
    CHECK(std::memcmp(again.data(), z.data(), 256 * static_cast<std::size_t>(z.blocks())) == 0);
    m.clearColumns();
    m.usePresent({});
    m.apply(r, again, pool);
    CHECK(std::memcmp(again.data(), atRest.data(), 256 * static_cast<std::size_t>(z.blocks())) == 0);
}

TEST_CASE("coherence is 1 if all nodes turn alike, and falls with the angle between those of one coarse node")
{
    std::mt19937 random(9);
    Problem problem(random, 40, 40, 2); // two coarse nodes, of twenty nodes each
    for (std::size_t row = 0; row < 40; ++row) {
        problem.corners[row] = {row < 20 ? 0 : 1, 0, 0, 0};
        problem.weights[row] = {1.0f, 0.0f, 0.0f, 0.0f};
    }
    TwoLevelPreconditioner m(problem.input());
    CHECK(m.coherence() == 1.0);
    // Half of the nodes of the second coarse node turn by the angle and half against it: the mean of their rotations
    // is diag(c, c, 1).
    for (const double angle : {0.3, 1.0, 2.0}) {
        std::vector<RotationBlock>& turns = m.rotations();
        for (int i = 0; i < 40; ++i) {
            const int row = problem.rows[static_cast<std::size_t>(i)];
            setRotation(turns, i, axisAngle({0, 0, 1}, row < 20 ? 1.1 : row % 2 == 0 ? angle : -angle));
        }
        const double c = std::cos(angle);
        CHECK(m.coherence() == Approx(std::sqrt((1.0 + 2.0 * c * c) / 3.0)).epsilon(1e-6));
    }
    CHECK(TwoLevelPreconditioner(problem.withoutCoarseLevel().input()).coherence() == 1.0);
}

TEST_CASE("blended rotations: nodes that have turned against each other follow the mean of their coarse nodes")
{
    std::mt19937 random(11);
    WorkerPool pool(2);
    Problem problem(random, 40, 40, 2); // two coarse nodes, of twenty nodes each
    for (std::size_t row = 0; row < 40; ++row) {
        problem.corners[row] = {row < 20 ? 0 : 1, 0, 0, 0};
        problem.weights[row] = {1.0f, 0.0f, 0.0f, 0.0f};
    }
    TwoLevelPreconditioner m(problem.input());
    const NodeArray r = randomNodes(random, 40);
    NodeArray z(r.blocks()), again(r.blocks()), own(r.blocks());
    m.apply(r, z, pool);
    CHECK_FALSE(m.blendRotations()); // nothing has turned
    // Those of the first coarse node turn alike. Those of the second turn by an angle, every other one against it.
    std::vector<RotationBlock> mean = m.rotations();
    for (int i = 0; i < 40; ++i) {
        const int row = problem.rows[static_cast<std::size_t>(i)];
        const Quat first = axisAngle(normalized(Vec3{1, 2, 3}), 1.1);
        setRotation(m.rotations(), i, row < 20 ? first : axisAngle({0, 0, 1}, row % 2 == 0 ? 1.0 : -1.0));
        setRotation(mean, i, row < 20 ? first : Quat{});
    }
    m.apply(r, own, pool);
    REQUIRE(m.blendRotations());
    CHECK_FALSE(m.blendRotations()); // they are already
    const double rz = m.apply(r, z, pool);
    const Eigen::VectorXd exact = densePreconditioner(problem, m.rotations(), mean) * dense(r, 40);
    CHECK((dense(z, 40) - exact).norm() < 1e-5 * exact.norm());
    CHECK((dense(own, 40) - exact).norm() > 0.01 * exact.norm());
    CHECK(rz == Approx(dense(r, 40).dot(exact)).epsilon(1e-5));
    // In halves, with something added in between, which only the coarse level sees.
    const int node = problem.rows[3] < 20 ? 3 : 4;
    const Vec3 change{0.3, -0.2, 0.5};
    NodeArray changed = r;
    m.smooth(r, pool);
    m.addToCoarseResidual(node, change);
    m.applyCoarse(r, z, pool);
    for (int k = 0; k < 3; ++k) changed[node][k] += static_cast<float>(change[k]);
    const Eigen::MatrixXd all = densePreconditioner(problem, m.rotations(), mean),
                          smooth = densePreconditioner(problem.withoutCoarseLevel(), m.rotations());
    const Eigen::VectorXd halves = smooth * dense(r, 40) + (all - smooth) * dense(changed, 40);
    CHECK((dense(z, 40) - halves).norm() < 1e-5 * halves.norm());
    m.useOwnRotations();
    m.apply(r, again, pool);
    CHECK(std::memcmp(again.data(), own.data(), 256 * static_cast<std::size_t>(z.blocks())) == 0);
}

TEST_CASE("any number of threads gives the same bits")
{
    std::mt19937 random(5);
    const Problem problem(random, 1500, 1400, 45); // six parts of nodes, three parts of coarse nodes and of panels
    TwoLevelPreconditioner m = rotatedPreconditioner(problem, random);
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

} // namespace two_level_preconditioner_test
