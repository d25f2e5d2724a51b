#include "filasofia/engine/elastic/rod.h"

#include "engine/meshes.h"

namespace rod_kernel_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

Vec3 acrossOf(Vec3 direction, Vec3 hint) { return normalized(hint - dot(hint, direction) * direction); }

RodPlace placeOf(const std::array<Vec3, 3>& x, Vec3 hint, double turn)
{
    const Vec3 e = normalized(x[1] - x[0]), f = normalized(x[2] - x[1]);
    RodPlace at{.x = x};
    at.directors[0] = acrossOf(e, hint);
    const Vec3 carried = transported(at.directors[0], e, f);
    at.directors[1] = std::cos(turn) * carried + std::sin(turn) * cross(f, carried);
    at.twist = turn;
    return at;
}

/// The place after small changes of the unknowns: directors are carried along, then turned.
RodPlace changed(const RodPlace& from, const RodVector& by)
{
    RodPlace at = from;
    for (std::size_t node = 0; node < 3; ++node)
        for (std::size_t i = 0; i < 3; ++i) at.x[node][static_cast<int>(i)] += by[4 * node + i];
    std::array<Vec3, 2> directions;
    for (std::size_t j = 0; j < 2; ++j) {
        const Vec3 before = normalized(from.x[j + 1] - from.x[j]);
        directions[j] = normalized(at.x[j + 1] - at.x[j]);
        const Vec3 carried = transported(from.directors[j], before, directions[j]);
        const double angle = by[4 * j + 3];
        at.directors[j] = std::cos(angle) * carried + std::sin(angle) * cross(directions[j], carried);
    }
    const double turn = rodTwist(at.directors, directions);
    at.twist = turn + 2.0 * M_PI * std::round((from.twist - turn) / (2.0 * M_PI));
    return at;
}

RodJoint jointOf(std::mt19937& random, bool curved)
{
    std::uniform_real_distribution<double> draw(-0.6, 0.6);
    RodJoint joint{.bend = 1.7, .twist = 0.9};
    for (auto& edge : joint.rest)
        for (double& each : edge) each = curved ? draw(random) : 0.0;
    return joint;
}

RodPlace randomPlace(std::mt19937& random)
{
    std::uniform_real_distribution<double> draw(-0.4, 0.4);
    std::array<Vec3, 3> x{Vec3{-1.1, 0, 0}, {0, 0, 0}, {0.8, 0, 0}};
    for (Vec3& each : x) each += Vec3{draw(random), draw(random), draw(random)};
    return placeOf(x, {0.2, draw(random) + 1.0, draw(random)}, 9.0 * draw(random));
}

RodVector unit(std::size_t i, double size)
{
    RodVector out{};
    out[i] = size;
    return out;
}

double times(const RodVector& a, const RodVector& b)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

/// [i][k]: minus the derivative of force i by unknown k.
std::array<RodVector, 12> numericStiffness(const RodJoint& joint, const RodPlace& at)
{
    constexpr double step = 1e-6;
    std::array<RodVector, 12> k{};
    for (std::size_t c = 0; c < 11; ++c) {
        const RodVector high = rodResponse(joint, changed(at, unit(c, step))).forces;
        const RodVector low = rodResponse(joint, changed(at, unit(c, -step))).forces;
        for (std::size_t r = 0; r < 11; ++r) k[r][c] = -(high[r] - low[r]) / (2.0 * step);
    }
    return k;
}

double entry(const RodTangent& tangent, std::size_t r, std::size_t c)
{
    double sum = 0.0;
    for (const RodTerm& each : tangent) sum += each.stiffness * each.gradient[r] * each.gradient[c];
    return sum;
}

} // namespace

TEST_CASE("forces and torques of a rod are minus the gradient of its energy, straight or curved at rest")
{
    std::mt19937 random(5);
    constexpr double step = 1e-6;
    for (int trial = 0; trial < 40; ++trial) {
        const RodJoint joint = jointOf(random, trial % 2 == 1);
        const RodPlace at = randomPlace(random);
        const RodVector forces = rodResponse(joint, at).forces;
        for (std::size_t i = 0; i < 11; ++i) {
            const double high = rodEnergy(joint, changed(at, unit(i, step)));
            const double low = rodEnergy(joint, changed(at, unit(i, -step)));
            CHECK_THAT(forces[i], Catch::WithinAbs(-(high - low) / (2.0 * step), 2e-7));
        }
    }
}

TEST_CASE("forces of a folded rod are the gradient too, and finite when it is folded flat")
{
    std::mt19937 random(6);
    constexpr double step = 1e-7;
    RodJoint joint = jointOf(random, true);
    joint.twist = 0.0; // its force is bounded there, and no gradient: materials of edges that fold spin without bound
    const RodPlace at = placeOf({Vec3{-1, 0, 0}, {0, 0, 0}, {-0.9, 0.08, 0.02}}, {0, 0.3, 1}, 0.2);
    const RodVector forces = rodResponse(joint, at).forces;
    for (std::size_t i = 0; i < 11; ++i) {
        const double high = rodEnergy(joint, changed(at, unit(i, step)));
        const double low = rodEnergy(joint, changed(at, unit(i, -step)));
        CHECK_THAT(forces[i], Catch::WithinAbs(-(high - low) / (2.0 * step), 2e-5));
    }
    for (const Vec3 last : {Vec3{-1, 0, 0}, {0, 0, 0}}) {
        const RodPlace flat{.x = {Vec3{-1, 0, 0}, {0, 0, 0}, last}, .directors = {Vec3{0, 1, 0}, {0, 1, 0}}};
        for (double each : rodResponse(joint, flat).forces) CHECK(std::isfinite(each));
        for (const RodTerm& term : rodResponse(joint, flat).tangent)
            for (double each : term.gradient) CHECK(std::isfinite(each));
    }
}

TEST_CASE("the tangent of a rod at rest is the second derivative of its energy")
{
    std::mt19937 random(7);
    for (int trial = 0; trial < 20; ++trial) {
        RodPlace at = randomPlace(random);
        at = placeOf(at.x, {0.1, 1.0, 0.3}, 0.0);
        if (trial % 2 == 0) at = placeOf({at.x[0], at.x[1], at.x[1] + 0.7 * (at.x[1] - at.x[0])}, {0, 1, 0}, 0.0);
        RodJoint joint{.bend = 1.7, .twist = 0.9, .rest = curvatureInMaterial(at)};
        CHECK_THAT(rodEnergy(joint, at), Catch::WithinAbs(0.0, 1e-15));
        const auto numeric = numericStiffness(joint, at);
        const RodTangent tangent = rodResponse(joint, at).tangent;
        for (std::size_t r = 0; r < 11; ++r)
            for (std::size_t c = 0; c < 11; ++c)
                CHECK_THAT(entry(tangent, r, c), Catch::WithinAbs(numeric[r][c], 1e-6));
    }
}

TEST_CASE("the tangent of a rod is exact for bending in one plane, and has no negative term anywhere")
{
    std::mt19937 random(8);
    for (int trial = 0; trial < 20; ++trial) {
        const double angle = 0.1 * trial;
        const RodPlace at = placeOf({Vec3{-1, 0, 0}, {0, 0, 0}, {std::cos(angle), std::sin(angle), 0}}, {0, 0, 1}, 0.0);
        const RodJoint joint{.bend = 1.7, .twist = 0.9};
        RodVector turn{}; // the last node on its circle about the second
        turn[8] = -std::sin(angle), turn[9] = std::cos(angle);
        double along = 0.0;
        for (const RodTerm& each : rodResponse(joint, at).tangent) {
            CHECK(each.stiffness >= 0.0);
            along += each.stiffness * times(each.gradient, turn) * times(each.gradient, turn);
        }
        // W = 2 B/l tan^2(angle / 2)
        const double half = 0.5 * angle, cosine = std::cos(half);
        const double exact = 1.7 * (1.0 + 2.0 * std::sin(half) * std::sin(half)) / std::pow(cosine, 4);
        CHECK_THAT(along, Catch::WithinRel(exact, 1e-9));
        for (const RodTerm& each : rodResponse(jointOf(random, true), randomPlace(random)).tangent)
            CHECK(each.stiffness >= 0.0);
    }
}

TEST_CASE("a rod that turns as a whole changes neither its curvature nor its twist")
{
    std::mt19937 random(9);
    for (int trial = 0; trial < 20; ++trial) {
        const RodPlace at = randomPlace(random);
        const RodJoint joint{.bend = 1.7, .twist = 0.9, .rest = curvatureInMaterial(at)};
        const Vec3 spin = randomVec3(random, 1.0), shift = randomVec3(random, 1.0);
        RodVector motion{};
        for (std::size_t node = 0; node < 3; ++node) {
            const Vec3 v = shift + cross(spin, at.x[node]);
            for (std::size_t i = 0; i < 3; ++i) motion[4 * node + i] = v[static_cast<int>(i)];
        }
        for (std::size_t j = 0; j < 2; ++j) motion[4 * j + 3] = dot(spin, normalized(at.x[j + 1] - at.x[j]));
        for (const RodTerm& each : rodResponse(joint, at).tangent)
            CHECK_THAT(times(each.gradient, motion) * std::sqrt(each.stiffness), Catch::WithinAbs(0.0, 1e-12));
    }
}

TEST_CASE("plastic curvature returns to the yield surface, and stays bit for bit within it")
{
    std::mt19937 random(10);
    std::uniform_real_distribution<double> draw(-0.6, 0.6);
    const auto drawn = [&] {
        RodCurvature out{};
        for (auto& edge : out)
            for (double& each : edge) each = draw(random);
        return out;
    };
    int flowed = 0;
    for (int trial = 0; trial < 200; ++trial) {
        const RodYield yield{0.4, trial % 2 == 0 ? 0.0 : 0.3};
        const RodCurvature rest = drawn(), now = drawn(), before = drawn();
        const RodCurvature after = plasticCurvature(yield, rest, now, before);
        for (std::size_t j = 0; j < 2; ++j) {
            std::array<double, 2> moment{}, trialMoment{}, flow{};
            for (std::size_t a = 0; a < 2; ++a) {
                const double elastic = now[j][a] - rest[j][a];
                moment[a] = elastic - after[j][a] - yield.hardening * after[j][a];
                trialMoment[a] = elastic - before[j][a] - yield.hardening * before[j][a];
                flow[a] = after[j][a] - before[j][a];
            }
            if (std::hypot(trialMoment[0], trialMoment[1]) <= yield.curvature) {
                CHECK(after[j] == before[j]);
                continue;
            }
            ++flowed;
            CHECK_THAT(std::hypot(moment[0], moment[1]), Catch::WithinRel(yield.curvature, 1e-12));
            // The flow has the direction of the moment, so it dissipates.
            CHECK_THAT(moment[0] * flow[1] - moment[1] * flow[0], Catch::WithinAbs(0.0, 1e-14));
            CHECK(moment[0] * flow[0] + moment[1] * flow[1] > 0.0);
        }
    }
    CHECK(flowed > 100);
    const RodCurvature much{{{9.0, -3.0}, {1.0, 2.0}}};
    const RodYield never{std::numeric_limits<double>::infinity(), 0.0};
    CHECK(plasticCurvature(never, {}, much, {}) == RodCurvature{});
}

} // namespace rod_kernel_test
