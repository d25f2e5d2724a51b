#include "filasofia/engine/constraint/coupled_solve.h"

#include "effort.h"
#include "engine/constraint/dense_body.h"

#include <random>

namespace coupled_solve_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

using Random = std::mt19937;

double uniform(Random& random, double low, double high) { return std::uniform_real_distribution(low, high)(random); }

Vec3 randomVector(Random& random) { return {uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)}; }

/// Masses with stiff springs between them and weak springs to the ground.
DenseBody randomBody(Random& random, int nodes, bool coarse)
{
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(3 * nodes, 3 * nodes);
    for (int i = 0; i < nodes; ++i) {
        a.block<3, 3>(3 * i, 3 * i) += uniform(random, 0.5, 2.0) * Eigen::Matrix3d::Identity();
        for (int j = 0; j < i; ++j) {
            const Vec3 d = randomVector(random);
            const Eigen::Vector3d n = Eigen::Vector3d(d.x, d.y, d.z).normalized();
            const Eigen::Matrix3d k = uniform(random, 0.0, 3.0) * n * n.transpose();
            a.block<3, 3>(3 * i, 3 * i) += k;
            a.block<3, 3>(3 * j, 3 * j) += k;
            a.block<3, 3>(3 * i, 3 * j) -= k;
            a.block<3, 3>(3 * j, 3 * i) -= k;
        }
    }
    const Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(3 * nodes, [&] { return uniform(random, -3.0, 3.0); });
    return {a, b, coarse};
}

struct Problem {
    std::vector<DenseBody> bodies;
    std::vector<std::vector<ContactPoint>> points;
    std::vector<Constraint> constraints;
    ConstraintRows rows;

    Problem(Random& random, int count, double friction, bool coarse)
    {
        const int nodes = 6;
        for (int b = 0; b < count; ++b) {
            bodies.push_back(randomBody(random, nodes, coarse));
            points.emplace_back();
            for (int i = 0; i < nodes; ++i) points.back().push_back({.node = i});
        }
        const auto add = [&](const Constraint& c, std::initializer_list<WeightedPoint> at) {
            rows.list.push_back({.first = static_cast<int>(rows.points.size()), .count = static_cast<int>(at.size())});
            rows.points.insert(rows.points.end(), at);
            constraints.push_back(c);
        };
        for (int k = 0; k < 5; ++k) { // nodes on the floor or on a moving surface
            Constraint c;
            c.frame = frameOf(normalized(randomVector(random)));
            c.friction = friction;
            c.sides[0].velocity = inWorld(c.frame, 0.3 * randomVector(random));
            c.bias = {uniform(random, -0.2, 0.4), 0.0, 0.0};
            add(c, {{k % nodes, 1.0}});
        }
        for (int k = 0; count > 1 && k < 4; ++k) { // a point of the first body against a triangle of the second
            Constraint c;
            c.frame = frameOf(normalized(randomVector(random)));
            c.friction = friction;
            c.bias = {uniform(random, -0.2, 0.2), 0.0, 0.0};
            const double s = uniform(random, 0.1, 0.5), t = uniform(random, 0.1, 0.4);
            add(c, {{k, 1.0}, {nodes + k, -s}, {nodes + (k + 1) % nodes, -t}, {nodes + (k + 2) % nodes, s + t - 1.0}});
        }
        Constraint held;
        held.kind = ConstraintKind::Weld;
        held.frame = frameOf({0.0, 1.0, 0.0});
        held.bias = 0.1 * randomVector(random);
        add(held, {{5, 1.0}});
    }
    Problem(const Problem&) = delete;

    CoupledReport solve(const CoupledLimits& limits)
    {
        std::vector<CoupledBody> list;
        for (DenseBody& body : bodies) list.push_back(coupled(body));
        for (std::size_t c = 0; c < constraints.size(); ++c) rows.list[c].constraint = &constraints[c];
        return solver.solve(limits, list, points, rows);
    }
    CoupledSolve solver;

    [[nodiscard]] Eigen::Vector3d at(const WeightedPoint& each) const
    {
        const auto body = static_cast<std::size_t>(each.point / 6);
        return each.weight * bodies[body].x.segment<3>(3 * (each.point % 6));
    }
    [[nodiscard]] Vec3 velocity(const ConstraintRow& row) const
    {
        const Constraint& c = *row.constraint;
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (const WeightedPoint& each : rows.pointsOf(row)) sum += at(each);
        return inFrame(c.frame, c.sides[0].velocity - c.sides[1].velocity + Vec3{sum.x(), sum.y(), sum.z()});
    }
    /// The largest entry of A x - b - J^T impulse.
    [[nodiscard]] double imbalance() const
    {
        std::vector<Eigen::VectorXd> rest;
        for (const DenseBody& body : bodies) rest.push_back(body.a * body.x - body.b);
        for (const ConstraintRow& row : rows.list) {
            const Vec3 world = inWorld(row.constraint->frame, row.constraint->impulse);
            for (const WeightedPoint& each : rows.pointsOf(row))
                rest[static_cast<std::size_t>(each.point / 6)].segment<3>(3 * (each.point % 6)) -=
                    each.weight * Eigen::Vector3d(world.x, world.y, world.z);
        }
        double worst = 0.0;
        for (const auto& r : rest) worst = std::max(worst, r.cwiseAbs().maxCoeff());
        return worst;
    }
};

const CoupledLimits kTight{
    .linear = {.tolerance = 1e-12, .smallAnswer = 1e-6, .maxIterations = 5000}, .nonlinear = 2000, .tolerance = 1e-10};

} // namespace

TEST_CASE("impulses of constraints balance the bodies' equations for every kind of body")
{
    Random random(7);
    for (int trial = 0; trial < 40; ++trial) {
        Problem scene(random, 1 + trial % 3, trial % 2 ? 0.4 : 0.0, trial % 4 < 2);
        const CoupledReport report = scene.solve(kTight);
        CHECK(report.converged);
        CHECK(scene.imbalance() < 1e-9);
    }
}

TEST_CASE("impulses carried from one solve to the next converge to the exact constraint law", "[cases]")
{
    Random random(11);
    for (int trial = 0; trial < cases(20); ++trial) {
        const double mu = trial % 2 ? 0.5 : 0.0;
        Problem scene(random, 1 + trial % 2, mu, true);
        CoupledReport report;
        for (int k = 0; k < 400; ++k) {
            report = scene.solve(kTight);
            for (Constraint& c : scene.constraints) c.impulse = c.multiplier;
        }
        CHECK(report.mismatch < 1e-8);
        CHECK(scene.imbalance() < 1e-6);
        int active = 0;
        for (const ConstraintRow& row : scene.rows.list) {
            const Constraint& c = *row.constraint;
            const Vec3 u = scene.velocity(row);
            INFO("trial " << trial << ", impulse " << c.impulse.x << " " << c.impulse.y << " " << c.impulse.z);
            if (c.bilateral()) { // does not move except for the bias
                CHECK(length(u + c.bias) < 1e-6);
                continue;
            }
            CHECK(c.impulse.x >= 0.0);
            CHECK(u.x + c.bias.x > -1e-6);
            CHECK(std::abs(c.impulse.x * (u.x + c.bias.x)) < 1e-6); // either a gap or a normal impulse
            const double along = std::hypot(c.impulse.y, c.impulse.z), speed = std::hypot(u.y, u.z);
            CHECK(along <= mu * c.impulse.x + 1e-7);
            if (c.impulse.x > 1e-6 && speed > 1e-5 && mu > 0.0) { // slides: full friction, against the motion
                ++active;
                CHECK(along == Approx(mu * c.impulse.x).margin(1e-6));
                CHECK((c.impulse.y * u.y + c.impulse.z * u.z) == Approx(-along * speed).margin(1e-6));
            }
        }
        if (mu > 0.0) CHECK(active > 0);
    }
}

TEST_CASE("a spring and a penalty contact move by the closed form of their stiffness")
{
    DenseBody body(2.0 * Eigen::MatrixXd::Identity(3, 3), Eigen::Vector3d(0.0, -1.0, 0.0), false);
    CoupledSolve solver;
    for (ConstraintKind kind : {ConstraintKind::Weld, ConstraintKind::Contact}) { // 2 u = -1 - 6 (u + 0.05)
        Constraint c;
        c.kind = kind;
        c.frame = frameOf({0.0, 1.0, 0.0});
        c.bias = {0.05, 0.0, 0.0};
        c.softness = 6.0;
        const ConstraintRows rows{.list = {{.constraint = &c, .first = 0, .count = 1}}, .points = {{0, 1.0}}};
        solver.solve(kTight, {coupled(body)}, {{{.node = 0}}}, rows);
        const double u = (-1.0 - 6.0 * 0.05) / 8.0;
        CHECK(body.x.y() == Approx(u).epsilon(1e-9));
        CHECK(c.impulse.x == Approx(-6.0 * (u + 0.05)).epsilon(1e-9));
    }
}

TEST_CASE("a solve without constraints solves the bodies' own equations")
{
    Random random(3);
    DenseBody body = randomBody(random, 8, true);
    body.guess = Eigen::VectorXd::Ones(24);
    CoupledSolve solver;
    const CoupledReport report = solver.solve(kTight, {coupled(body)}, {{}}, {});
    CHECK(report.converged);
    CHECK((body.a * body.x - body.b).norm() < 1e-9);
}

TEST_CASE("the filter prevents stiff contacts from costing iterations")
{
    Random random(5);
    std::array<int, 2> iterations{};
    for (int k = 0; k < 2; ++k) {
        Random same(5);
        Problem scene(same, 2, 0.3, true);
        CoupledLimits limits = kTight;
        limits.linear.tolerance = 1e-6;
        limits.tolerance = 1.0; // converges by the energy alone
        limits.kappa.contact = k == 0 ? 1.0 : 1e4;
        limits.nonlinear = 0; // the same contacts throughout, which is what the filter is for
        const CoupledReport report = scene.solve(limits);
        CHECK(report.residual <= limits.linear.tolerance);
        iterations[static_cast<std::size_t>(k)] = report.iterations;
    }
    CHECK(iterations[1] <= 3 * iterations[0]);
}

} // namespace coupled_solve_test
