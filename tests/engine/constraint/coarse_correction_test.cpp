#include "filasofia/engine/constraint/coarse_correction.h"

#include "engine/constraint/dense_body.h"

#include <algorithm>
#include <optional>
#include <random>

namespace coarse_correction_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

constexpr int kNodes = 8;

double uniform(std::mt19937& random, double low, double high)
{
    return std::uniform_real_distribution(low, high)(random);
}
Vec3 randomVector(std::mt19937& random)
{
    const double x = uniform(random, -1, 1), y = uniform(random, -1, 1), z = uniform(random, -1, 1);
    return {x, y, z};
}
Eigen::MatrixXd randomSpd(std::mt19937& random, int n)
{
    const Eigen::MatrixXd half = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return uniform(random, -1, 1); });
    return half * half.transpose() + Eigen::MatrixXd::Identity(n, n);
}

/// Two bodies with constraints between a node of the first and two nodes of the second, or space.
struct Problem {
    std::vector<DenseBody> bodies;
    std::vector<Constraint> constraints;
    ConstraintRows rows;
    std::vector<Mat3> filters;
    std::vector<int> first = {0, kNodes, 2 * kNodes};

    Problem(std::mt19937& random, int count)
    {
        std::vector<ContactPoint> points;
        for (int i = 0; i < kNodes; ++i) points.push_back({.node = i});
        for (int b = 0; b < 2; ++b) {
            bodies.emplace_back(randomSpd(random, 3 * kNodes), Eigen::VectorXd::Zero(3 * kNodes), true);
            bodies.back().begin(points);
        }
        for (int k = 0; k < count; ++k) {
            Constraint c;
            c.sides[0].position = randomVector(random);
            c.frame = frameOf(normalized(randomVector(random)));
            rows.list.push_back({.first = static_cast<int>(rows.points.size()), .count = 3});
            rows.points.insert(rows.points.end(),
                               {{k % kNodes, 1.0}, {kNodes + k % kNodes, -0.3}, {kNodes + (k + 3) % kNodes, -0.7}});
            constraints.push_back(c);
            const double normal = uniform(random, 1, 50), along = uniform(random, 1, 50);
            const Mat3 frame = asMatrix(c.frame);
            filters.push_back(transpose(frame) * (Mat3::diagonal({normal, along, along}) * frame));
        }
    }
    Problem(const Problem&) = delete;
    [[nodiscard]] std::vector<CoupledBody> list() { return {coupled(bodies[0]), coupled(bodies[1])}; }
    using Motions = std::vector<ConstraintMotions> (*)(const ConstraintNetwork&);
    void correct(CoarseCorrection& correction, Motions motions = patchMotions)
    {
        for (std::size_t c = 0; c < constraints.size(); ++c) rows.list[c].constraint = &constraints[c];
        const std::vector<CoupledBody> all = list();
        const ConstraintNetwork network{all, first, rows, filters};
        correction.make(network, motions(network));
    }

    /// B', column by column.
    Eigen::MatrixXd corrected(CoarseCorrection& patches)
    {
        const int n = 3 * kNodes;
        Eigen::MatrixXd all(2 * n, 2 * n);
        for (int column = 0; column < 2 * n; ++column) {
            for (int b = 0; b < 2; ++b) {
                DenseBody& body = bodies[static_cast<std::size_t>(b)];
                body.setResidual(Eigen::VectorXd::Unit(2 * n, column).segment(b * n, n));
                body.smooth();
            }
            if (!patches.empty()) patches.project(list());
            for (std::size_t b = 0; b < 2; ++b) {
                bodies[b].applyCoarse(patches.shares(b));
                std::vector<Vec3> w(kNodes), z(kNodes);
                bodies[b].read(SolveVector::Smoothed, w);
                bodies[b].read(SolveVector::Preconditioned, z);
                for (int i = 0; i < kNodes; ++i)
                    for (int k = 0; k < 3; ++k)
                        all(static_cast<int>(b) * n + 3 * i + k, column) =
                            z[static_cast<std::size_t>(i)][k] - w[static_cast<std::size_t>(i)][k];
            }
        }
        return all;
    }
    /// (B^-1 + J^T M J)^-1
    [[nodiscard]] Eigen::MatrixXd exact() const
    {
        const int n = 3 * kNodes;
        Eigen::MatrixXd a = Eigen::MatrixXd::Zero(2 * n, 2 * n);
        for (int b = 0; b < 2; ++b)
            a.block(b * n, b * n, n, n) = 2.0 * bodies[static_cast<std::size_t>(b)].a; // B is half of the inverse
        for (std::size_t c = 0; c < filters.size(); ++c) {
            Eigen::MatrixXd j = Eigen::MatrixXd::Zero(3, 2 * n);
            for (const WeightedPoint& each : rows.pointsOf(rows.list[c]))
                for (int k = 0; k < 3; ++k) j(k, 3 * each.point + k) += each.weight;
            Eigen::Matrix3d m;
            for (int row = 0; row < 3; ++row)
                for (int k = 0; k < 3; ++k) m(row, k) = filters[c][row][k];
            a += j.transpose() * m * j;
        }
        return a.inverse();
    }
};

} // namespace

TEST_CASE("the correction is exact if its constraints resist only the motions of the patch")
{
    std::mt19937 random(1);
    Problem scene(random, 1);
    CoarseCorrection patches;
    scene.correct(patches);
    REQUIRE_FALSE(patches.empty());
    const Eigen::MatrixXd exact = scene.exact();
    CHECK((scene.corrected(patches) - exact).norm() <= 1e-5 * exact.norm()); // up to the shift
}

TEST_CASE("the correction is exact if its motions are those of all coarse nodes")
{
    std::mt19937 random(5);
    for (const int count : {1, 7, 40}) {
        Problem scene(random, count);
        CoarseCorrection correction;
        scene.correct(correction, coarseNodeMotions); // every node is a coarse node of these bodies
        REQUIRE_FALSE(correction.empty());
        const Eigen::MatrixXd exact = scene.exact();
        CHECK((scene.corrected(correction) - exact).norm() <= 1e-4 * exact.norm()); // up to the shift
    }
}

TEST_CASE("constraints at different pieces of a body form separate patches")
{
    std::mt19937 random(4);
    Problem scene(random, 3);
    for (int c = 0; c < 3; ++c) scene.rows.list[static_cast<std::size_t>(c)].pieces = {c / 2, c % 2};
    CoarseCorrection patches;
    scene.correct(patches);
    const Eigen::MatrixXd exact = scene.exact();
    CHECK((scene.corrected(patches) - exact).norm() <= 1e-5 * exact.norm());
}

TEST_CASE("the correction never overcorrects: B' lies between B and the true inverse")
{
    std::mt19937 random(2);
    for (int trial = 0; trial < 6; ++trial) {
        Problem scene(random, trial < 5 ? 7 : 300);
        for (int c = 0; c < static_cast<int>(scene.filters.size()) && trial == 5; ++c)
            scene.rows.list[static_cast<std::size_t>(c)].pieces = {c, 0}; // more patches than are counted
        CoarseCorrection none, patches;
        const Eigen::MatrixXd before = scene.corrected(none);
        scene.correct(patches);
        const Eigen::MatrixXd after = scene.corrected(patches), exact = scene.exact();
        CHECK((after - after.transpose()).norm() <= 1e-10 * after.norm());
        const auto smallest = [](const Eigen::MatrixXd& m) {
            return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(0.5 * (m + m.transpose())).eigenvalues().minCoeff();
        };
        CHECK(smallest(after - exact) >= -1e-10);
        CHECK(smallest(before - after) >= -1e-10);
        CHECK((after - exact).norm() < 0.8 * (before - exact).norm());
    }
}

/// The first `count` constraints as pairs that attachments hold, at `nodes` of each body.
TiedCoarse tied(Problem& scene, int count, const std::vector<int>& nodes)
{
    const auto numberOf = [&](int point) {
        const std::size_t body = point < kNodes ? 0 : 1;
        const auto at = std::ranges::find(nodes, point - static_cast<int>(body) * kNodes);
        return at == nodes.end() ? std::optional<std::size_t>{} : body * nodes.size() + (at - nodes.begin());
    };
    std::vector<TiedPair> pairs;
    for (int c = 0; c < count; ++c) {
        const auto row = static_cast<std::size_t>(c);
        scene.constraints[row].tied = true;
        TiedPair& pair = pairs.emplace_back();
        pair.stiffness = trace(scene.filters[row]) / 3.0;
        scene.filters[row] = pair.stiffness * Mat3::identity();
        for (const WeightedPoint& each : scene.rows.pointsOf(scene.rows.list[row]))
            if (const auto node = numberOf(each.point)) pair.parts.push_back({*node, each.weight * Mat3::identity()});
    }
    TiedCoarse coarse;
    REQUIRE(coarse.build({nodes, nodes}, pairs, [&](std::size_t body, std::size_t i, std::size_t k) {
        const auto unknown = [&](std::size_t of) { return 3 * nodes[of / 3] + static_cast<int>(of % 3); };
        return (0.5 * scene.bodies[body].a.inverse())(unknown(i), unknown(k));
    }));
    return coarse;
}

TEST_CASE("coarse levels that are tied are as exact as those that learn of their constraints in every step")
{
    std::mt19937 random(6);
    const std::vector<int> nodes{0, 1, 2, 3, 4, 5, 6, 7};
    for (const int count : {1, 5, 12}) { // 12 constraints
        Problem scene(random, 12);
        const TiedCoarse coarse = tied(scene, count, nodes);
        const std::vector<SolvedTie> ties{{&coarse, {0, 1}}};
        CoarseCorrection correction;
        correction.begin(ties);
        scene.correct(correction, coarseNodeMotions);
        CHECK(correction.hasMotions() == (count < 12));
        const Eigen::MatrixXd exact = scene.exact();
        CHECK((scene.corrected(correction) - exact).norm() <= 1e-4 * exact.norm()); // floats, and the shift
    }
}

TEST_CASE("whatever ties leave out, and however stiff they are, B' stays symmetric and positive definite")
{
    std::mt19937 random(7);
    for (const double stiffness : {1e-3, 1.0, 1e4, 1e8}) {
        Problem scene(random, 12);
        for (Mat3& filter : scene.filters) filter *= stiffness;
        const TiedCoarse coarse = tied(scene, 12, {1, 3, 4, 6}); // the other nodes' parts are missing
        const std::vector<SolvedTie> ties{{&coarse, {0, 1}}};
        CoarseCorrection correction;
        correction.begin(ties);
        const Eigen::MatrixXd after = scene.corrected(correction);
        CHECK((after - after.transpose()).norm() <= 1e-6 * after.norm());
        const Eigen::MatrixXd even = 0.5 * (after + after.transpose());
        CHECK(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(even).eigenvalues().minCoeff() > 0.0);
    }
}

TEST_CASE("coarse levels are not tied without coarse nodes, or with too many")
{
    const auto inverse = [](std::size_t, std::size_t i, std::size_t k) { return i == k ? 1.0 : 0.0; };
    TiedCoarse coarse;
    CHECK_FALSE(coarse.build({{}, {}}, {}, inverse));
    CHECK_FALSE(coarse.build({std::vector<int>(TiedCoarse::kMaxNodes + 1)}, {}, inverse));
    CHECK_FALSE(coarse.build({{0}, {0}}, {}, [](std::size_t, std::size_t, std::size_t) { return -1.0; }));
}

TEST_CASE("without active constraints there is no correction")
{
    std::mt19937 random(3);
    Problem scene(random, 3);
    for (Mat3& filter : scene.filters) filter = {};
    CoarseCorrection patches;
    scene.correct(patches);
    CHECK(patches.empty());
    CHECK(patches.shares(1).empty());
}

} // namespace coarse_correction_test
