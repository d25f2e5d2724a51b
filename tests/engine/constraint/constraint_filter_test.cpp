#include "filasofia/engine/constraint/constraint_filter.h"

#include "engine/constraint/random_body.h"

namespace constraint_filter_test {

using namespace filasofia;
using namespace filasofia::engine;

TEST_CASE("the filter of all constraints is what Woodbury's formula makes of them, between bodies of any size")
{
    std::mt19937 random(7);
    std::normal_distribution<double> number;
    const auto vector = [&] { return Vec3{number(random), number(random), number(random)}; };
    RandomBody one(random, 2, 5, false), two(random, 3, 4, true), three(random, 1, 2, false);
    const std::array<RandomBody*, 3> made{&one, &two, &three};
    const std::array<CoupledBody, 3> bodies{CoupledBody{.smoother = &one}, {.smoother = &two}, {.smoother = &three}};
    const std::vector<int> first{0, 5, 9, 11};

    // Rows between two bodies, on one body alone, with two points on one body, and one that takes no part.
    const std::vector<std::vector<WeightedPoint>> points{{{0, 1.0}, {5, -1.0}},  {{1, 1.0}, {6, -1.0}},
                                                         {{2, 0.5}, {3, 0.5}},   {{7, 1.0}, {9, -1.0}},
                                                         {{4, 1.0}, {10, -1.0}}, {{8, 1.0}}};
    std::vector<Constraint> constraints(points.size());
    ConstraintRows rows;
    std::vector<Vec3> sigma, u;
    for (std::size_t r = 0; r < points.size(); ++r) {
        constraints[r].frame = frameOf(normalized(vector()));
        rows.list.push_back({.constraint = &constraints[r],
                             .first = static_cast<int>(rows.points.size()),
                             .count = static_cast<int>(points[r].size())});
        rows.points.insert(rows.points.end(), points[r].begin(), points[r].end());
        sigma.push_back(r == 3 ? Vec3{} : Vec3{100.0, 10.0, r == 1 ? 0.0 : 1000.0});
        u.push_back(vector());
    }

    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(18, 18), j = Eigen::MatrixXd::Zero(18, 18);
    Eigen::VectorXd s(18), velocities(18);
    const std::array<Eigen::Index, 3> offset{0, 6, 15};
    for (std::size_t b = 0; b < 3; ++b)
        a.block(offset[b], offset[b], made[b]->d.rows(), made[b]->d.rows()) = made[b]->d;
    for (std::size_t r = 0; r < points.size(); ++r)
        for (Eigen::Index k = 0; k < 3; ++k) {
            const auto axis = static_cast<std::size_t>(k), at = 3 * r + axis;
            s[static_cast<Eigen::Index>(at)] = sigma[r][axis];
            velocities[static_cast<Eigen::Index>(at)] = u[r][axis];
            for (const auto& [point, weight] : points[r]) {
                const std::size_t b = point < 5 ? 0 : point < 9 ? 1 : 2;
                const Vec3 f = constraints[r].frame[axis];
                j.block(static_cast<Eigen::Index>(at), offset[b], 1, made[b]->d.rows()) +=
                    weight * Eigen::RowVector3d(f.x, f.y, f.z) * made[b]->j[static_cast<std::size_t>(point - first[b])];
            }
        }
    const Eigen::MatrixXd k = a + j.transpose() * s.asDiagonal() * j;
    const Eigen::VectorXd expected = s.asDiagonal() * velocities -
                                     s.asDiagonal() * (j * k.ldlt().solve(j.transpose() * s.asDiagonal() * velocities));

    ConstraintFilter filter;
    filter.begin(bodies, first, rows);
    REQUIRE(filter.build(sigma));
    std::vector<Vec3> impulses = u;
    filter.apply(impulses);
    for (std::size_t r = 0; r < points.size(); ++r)
        for (std::size_t axis = 0; axis < 3; ++axis)
            CHECK(impulses[r][axis] ==
                  Approx(expected[static_cast<Eigen::Index>(3 * r + axis)]).margin(1e-9 * expected.norm()));
    CHECK(impulses[3] == Vec3{});
    sigma[0].x = -1e6; // no constraint is like that
    CHECK_FALSE(filter.build(sigma));
}

} // namespace constraint_filter_test
