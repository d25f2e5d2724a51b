#include "filasofia/engine/constraint/impulse_sweeps.h"

#include "engine/constraint/random_body.h"

namespace impulse_sweeps_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

/// Constraints of all kinds that rigid bodies have, between bodies whose D couples its blocks or does not.
struct Problem {
    std::mt19937 random;
    RandomBody one, two, three;
    std::array<CoupledBody, 3> bodies{CoupledBody{.smoother = &one}, {.smoother = &two}, {.smoother = &three}};
    std::vector<int> first{0, 5, 9, 11};
    std::vector<Constraint> constraints;
    ConstraintRows rows;
    std::vector<Vec3> start; ///< [m/s] velocities without impulses
    Vec3 stiffness{20.0, 20.0, 20.0};

    explicit Problem(unsigned seed)
        : random(seed), one(random, 2, 5, false), two(random, 3, 4, true), three(random, 1, 2, false)
    {
        using enum ConstraintKind;
        const std::vector<std::vector<WeightedPoint>> points{{{0, 1.0}, {5, -1.0}},
                                                             {{1, 1.0}, {6, -1.0}},
                                                             {{2, 0.5}, {3, 0.5}},
                                                             {{7, 1.0}, {9, -1.0}},
                                                             {{8, 1.0}},
                                                             {{4, 1.0}, {10, -1.0}},
                                                             {{9, 1.0}},
                                                             {{0, 1.0}}};
        const std::vector<ConstraintKind> kinds{Contact, Contact, Contact,       Contact,
                                                Contact, Weld,    JointFriction, JointLimit};
        for (std::size_t r = 0; r < points.size(); ++r) {
            Constraint c;
            c.kind = kinds[r];
            c.frame = frameOf(normalized(vector()));
            c.bias = 0.1 * vector();
            c.friction = kinds[r] == Contact ? 0.5 : 0.0;
            if (kinds[r] == JointFriction) c.maxImpulse = 0.01;
            if (r == 1) c.maxImpulse = 0.05; // a contact that yields
            constraints.push_back(c);
            start.push_back(vector());
        }
        for (std::size_t r = 0; r < points.size(); ++r) {
            rows.list.push_back({.constraint = &constraints[r],
                                 .first = static_cast<int>(rows.points.size()),
                                 .count = static_cast<int>(points[r].size())});
            rows.points.insert(rows.points.end(), points[r].begin(), points[r].end());
        }
    }
    Problem(const Problem&) = delete;

    Vec3 vector()
    {
        std::normal_distribution<double> number;
        return {number(random), number(random), number(random)};
    }
    /// J, in the frames of the rows.
    [[nodiscard]] Eigen::MatrixXd jacobian() const
    {
        Eigen::MatrixXd j = Eigen::MatrixXd::Zero(3 * static_cast<Eigen::Index>(constraints.size()), 18);
        for (std::size_t r = 0; r < constraints.size(); ++r)
            for (const auto& [point, weight] : rows.pointsOf(rows.list[r])) {
                const std::size_t b = point < 5 ? 0 : point < 9 ? 1 : 2;
                const Eigen::MatrixXd& of = body(b).j[static_cast<std::size_t>(point - first[b])];
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    const Vec3 f = constraints[r].frame[axis];
                    j.block(static_cast<Eigen::Index>(3 * r + axis), offset(b), 1, of.cols()) +=
                        weight * Eigen::RowVector3d(f.x, f.y, f.z) * of;
                }
            }
        return j;
    }
    [[nodiscard]] Eigen::MatrixXd matrix() const
    {
        Eigen::MatrixXd a = Eigen::MatrixXd::Zero(18, 18);
        for (std::size_t b = 0; b < 3; ++b)
            a.block(offset(b), offset(b), body(b).d.rows(), body(b).d.rows()) = body(b).d;
        return a;
    }

private:
    [[nodiscard]] const RandomBody& body(std::size_t b) const { return b == 0 ? one : b == 1 ? two : three; }
    static Eigen::Index offset(std::size_t b) { return b == 0 ? 0 : b == 1 ? 6 : 15; }
};

} // namespace

TEST_CASE("sweeps end at the impulses that all constraints' laws ask for, between bodies of any sort")
{
    int touching = 0, sliding = 0, held = 0;
    for (unsigned seed = 1; seed <= 40; ++seed) {
        Problem problem(seed);
        ConstraintColumns columns;
        columns.collect(problem.bodies, problem.first, problem.rows);
        ImpulseSweeps sweeps;
        REQUIRE(sweeps.begin(columns));
        std::vector<Vec3> impulses(problem.constraints.size());
        for (int sweep = 0; sweep < 2000; ++sweep)
            for (std::size_t r = 0; r < impulses.size(); ++r) {
                const Vec3 u = problem.start[r] + sweeps.velocityOf(r);
                const Vec3 to = sweeps.relax(r, problem.constraints[r], problem.stiffness, u, impulses[r]);
                sweeps.add(r, to - impulses[r]);
                impulses[r] = to;
            }
        Eigen::VectorXd all(3 * impulses.size());
        for (std::size_t r = 0; r < impulses.size(); ++r)
            for (std::size_t axis = 0; axis < 3; ++axis)
                all[static_cast<Eigen::Index>(3 * r + axis)] = impulses[r][axis];
        const Eigen::MatrixXd j = problem.jacobian();
        const Eigen::VectorXd changes = j * problem.matrix().ldlt().solve(j.transpose() * all);
        for (std::size_t r = 0; r < impulses.size(); ++r) {
            const Eigen::Vector3d change = changes.segment<3>(static_cast<Eigen::Index>(3 * r));
            const Vec3 u = problem.start[r] + Vec3{change.x(), change.y(), change.z()};
            const Constraint& c = problem.constraints[r];
            const Projected lawful = project(c, -1.0 * times(problem.stiffness, c.bias + u));
            CAPTURE(seed);
            CAPTURE(r);
            CHECK(length(lawful.impulse - impulses[r]) < 1e-8);
            touching += c.kind == ConstraintKind::Contact && lawful.active ? 1 : 0;
            sliding += c.kind == ConstraintKind::Contact && lawful.active && lawful.slip < 1.0 ? 1 : 0;
            held += impulses[r].x == c.maxImpulse ? 1 : 0;
        }
    }
    CHECK(touching > 20);
    CHECK(sliding > 5);
    CHECK(touching - sliding > 5);
    CHECK(held > 5);
}

} // namespace impulse_sweeps_test
