#include "filasofia/engine/collision/feature_pass.h"

#include "filasofia/geometry/distance.h"

#include "engine/meshes.h"

#include <algorithm>
#include <cmath>

namespace feature_pass_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

constexpr double kNear = 1e-6; // [m] in the resolution of time they move by less
constexpr int kCases = 4000, kSamples = 4000;

MovedPoint randomPoint(std::mt19937& random) { return {randomVec3(random, 1.0), randomVec3(random, 1.0)}; }

double volume(Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return dot(cross(b - a, c - a), d - a); }

/// The first sample after which the volume changes its sign while `within(time)` is true; below 0: none.
template <class Volume, class Within> double firstBySampling(const Volume& volumeAt, const Within& within)
{
    for (int i = 0; i < kSamples; ++i) {
        const double from = double(i) / kSamples, to = double(i + 1) / kSamples;
        if (volumeAt(from) * volumeAt(to) < 0.0 && within(0.5 * (from + to))) return from;
    }
    return -1.0;
}

} // namespace

TEST_CASE("edges that pass through each other meet where sampling says")
{
    std::mt19937 random(3);
    int met = 0;
    for (int i = 0; i < kCases; ++i) {
        const MovedEdge one{randomPoint(random), randomPoint(random)}, two{randomPoint(random), randomPoint(random)};
        const auto found = firstMeeting(one, two, kNear);
        // Only what is clear of the edges' ends by more than the samples are apart.
        const auto placesAt = [&](double t) {
            const Vec3 a = one[0].at(t), u = one[1].at(t) - a, b = two[0].at(t), v = two[1].at(t) - b;
            const Vec3 across = cross(u, v);
            const double area = lengthSquared(across);
            return std::array{dot(cross(b - a, v), across) / area, dot(cross(b - a, u), across) / area};
        };
        const auto inside = [&](double t, double margin) {
            const auto [s, r] = placesAt(t);
            return std::min({s, r, 1.0 - s, 1.0 - r}) > margin;
        };
        const auto volumeAt = [&](double t) { return volume(one[0].at(t), one[1].at(t), two[0].at(t), two[1].at(t)); };
        const double clear = firstBySampling(volumeAt, [&](double t) { return inside(t, 0.02); });
        const double perhaps = firstBySampling(volumeAt, [&](double t) { return inside(t, -0.02); });
        if (clear >= 0.0) REQUIRE(found);
        if (!found) continue;
        ++met;
        CHECK(perhaps >= 0.0);
        CHECK(found->time >= perhaps - 1e-6);
        if (clear >= 0.0) CHECK(found->time <= clear + 1.0 / kSamples + 1e-6);
        const Vec3 p = one[0].at(found->time) + found->first * (one[1].at(found->time) - one[0].at(found->time));
        const Vec3 q = two[0].at(found->time) + found->second * (two[1].at(found->time) - two[0].at(found->time));
        CHECK(distance(p, q) < 1.001 * kNear);
    }
    CHECK(met > kCases / 50);
}

TEST_CASE("points that pass through triangles meet them where sampling says")
{
    std::mt19937 random(4);
    int met = 0;
    for (int i = 0; i < kCases; ++i) {
        const MovedPoint point = randomPoint(random);
        const MovedTriangle triangle{randomPoint(random), randomPoint(random), randomPoint(random)};
        const auto found = firstMeeting(point, triangle, kNear);
        const auto cornersAt = [&](double t) {
            return std::array{triangle[0].at(t), triangle[1].at(t), triangle[2].at(t)};
        };
        const auto inside = [&](double t, double margin) {
            const auto [a, b, c] = cornersAt(t);
            const Vec3 p = point.at(t), n = cross(b - a, c - a);
            const double whole = lengthSquared(n);
            return std::min({dot(n, cross(b - a, p - a)), dot(n, cross(c - b, p - b)), dot(n, cross(a - c, p - c))}) >
                   margin * whole;
        };
        const auto volumeAt = [&](double t) {
            const auto [a, b, c] = cornersAt(t);
            return volume(a, b, c, point.at(t));
        };
        const double clear = firstBySampling(volumeAt, [&](double t) { return inside(t, 0.02); });
        const double perhaps = firstBySampling(volumeAt, [&](double t) { return inside(t, -0.02); });
        if (clear >= 0.0) REQUIRE(found);
        if (!found) continue;
        ++met;
        CHECK(perhaps >= 0.0);
        CHECK(found->time >= perhaps - 1e-6);
        if (clear >= 0.0) CHECK(found->time <= clear + 1.0 / kSamples + 1e-6);
        const auto [a, b, c] = cornersAt(found->time);
        CHECK(distance(point.at(found->time), found->weights[0] * a + found->weights[1] * b + found->weights[2] * c) <
              1.001 * kNear);
    }
    CHECK(met > kCases / 50);
}

TEST_CASE("what moves together, or side by side, does not meet")
{
    const Vec3 shift{0.3, -0.2, 0.5};
    const auto moved = [&](Vec3 from) { return MovedPoint{from, from + shift}; };
    const MovedEdge one{moved({0, 0, 0}), moved({1, 0, 0})}, above{moved({0.5, -1, 1e-3}), moved({0.5, 1, 1e-3})};
    CHECK_FALSE(firstMeeting(one, above, 1e-4));
    const MovedTriangle triangle{moved({0, 0, 0}), moved({1, 0, 0}), moved({0, 1, 0})};
    CHECK_FALSE(firstMeeting(moved({0.2, 0.2, 1e-3}), triangle, 1e-4));
    // A point that passes the plane beside the triangle.
    CHECK_FALSE(firstMeeting(MovedPoint{{2, 2, 1}, {2, 2, -1}},
                             MovedTriangle{MovedPoint{{0, 0, 0}, {0, 0, 0}}, MovedPoint{{1, 0, 0}, {1, 0, 0}},
                                           MovedPoint{{0, 1, 0}, {0, 1, 0}}},
                             1e-4));
}

} // namespace feature_pass_test
