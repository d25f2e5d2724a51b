#include "filasofia/testing/linking.h"

#include "verification/rods.h"

namespace rod_ring_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;
using testing::linkingNumber;
using testing::writhe;

namespace {

constexpr double kRadius = 0.05; ///< [m] how large the ring is

/// A ring in the xy plane that would be straight.
RodBodyDef ringOf(int nodes, double twist)
{
    RodBodyDef def{.closed = true, .radius = 1e-3, .youngModulus = 1e8, .poissonRatio = 0.4};
    for (int i = 0; i < nodes; ++i) {
        const double angle = 2.0 * kPi * i / nodes;
        def.points.push_back({kRadius * std::cos(angle), kRadius * std::sin(angle), 0});
    }
    def.rayleigh = {0.0, 0.0};
    def.gravity = false;
    def.twist = twist;
    return def;
}

/// Michell 1889: the twist at which a ring leaves its plane.
double criticalTwist(const RodBodyDef& def) { return 2.0 * kPi * std::sqrt(3.0) * bendOf(def) / twistOf(def); }

/// The part of the motion out of the plane that has two waves around the ring.
double waves(const SoftState& state)
{
    double c = 0.0, s = 0.0;
    const std::size_t count = state.x.size();
    for (std::size_t i = 0; i < count; ++i) {
        const double angle = 2.0 * kPi * static_cast<double>(i) / static_cast<double>(count);
        c += state.x[i].z * std::cos(2.0 * angle);
        s += state.x[i].z * std::sin(2.0 * angle);
    }
    return std::hypot(c, s);
}

/// Adds a disturbance out of the plane, with two waves.
void disturb(Stage& stage, double size)
{
    for (std::size_t i = 0; i < stage.soft().x.size(); ++i) {
        const double angle = 2.0 * kPi * static_cast<double>(i) / static_cast<double>(stage.soft().x.size());
        stage.soft().x[i].z += size * std::cos(2.0 * angle);
    }
}

double turnsOfTwist(const RodState& rod)
{
    double sum = 0.0;
    for (double each : rod.twists) sum += each;
    return sum / (2.0 * kPi);
}

} // namespace

TEST_CASE("a twisted ring leaves its plane at Michell's twist")
{
    const auto growth = [](double part) {
        RodBodyDef def = ringOf(200, 0.0);
        def.twist = part * criticalTwist(def);
        Stage stage;
        stage.add(def);
        stage.step(0.0);
        disturb(stage, 1e-9);
        // The frequency of that wave without a twist: n^2 (n^2 - 1)^2 / (n^2 + 1) B / (rho A R^4).
        const double omega = std::sqrt(7.2 * bendOf(def) / (def.density * areaOf(def))) / (kRadius * kRadius);
        stage.run(300, 0.3 / omega); // what else there is in it dies
        const double before = waves(stage.soft());
        stage.run(300, 0.3 / omega);
        return std::log(waves(stage.soft()) / before);
    };
    verify("rod: Michell, ring of 200 nodes, 0.98 of the twist: logarithm of a disturbance's growth", growth(0.98),
           0.0);
    verifyWithin("rod: Michell, ring of 200 nodes, 1.02 of the twist: logarithm of a disturbance's growth",
                 growth(1.02), 0.0, 100.0);
}

TEST_CASE("a ring that winds up under twist keeps its linking number, the sum of twist and writhe")
{
    RodBodyDef def = ringOf(120, 0.0);
    def.twist = 2.0 * criticalTwist(def);
    def.rayleigh.mass = 5.0;
    def.collision = RodCollision{};
    Stage stage;
    stage.add(def);
    stage.step(0.0);
    disturb(stage, 1e-5);
    const double start = turnsOfTwist(stage.soft().rod) + writhe(stage.soft().x);
    double worst = 0.0, most = 0.0;
    int touching = 0;
    for (int i = 0; i < 2000; ++i) {
        touching = std::max(touching, stage.step(1e-3).contacts.active);
        if (i % 20 != 0) continue;
        const double wound = writhe(stage.soft().x);
        most = std::max(most, std::abs(wound));
        worst = std::max(worst, std::abs(turnsOfTwist(stage.soft().rod) + wound - start));
    }
    verify(text("rod: ring, twice Michell's twist, writhe of up to ", 0.01 * std::round(100.0 * most),
                " turns, touches itself: largest change of twist and writhe together, in turns"),
           worst, 1e-2);
    CHECK(most > 0.7);
    CHECK(touching > 0);
}

TEST_CASE("two linked rings that are pulled apart stay linked")
{
    constexpr int nodes = 60;
    RodBodyDef def = ringOf(nodes, 0.0);
    def.radius = 0.5e-3;
    def.straight = false;
    def.collision = RodCollision{};
    def.rayleigh.mass = 5.0;
    RodBodyDef other = def;
    other.pose = {{kRadius, 0, 0}, axisAngle({1, 0, 0}, 0.5 * kPi)};
    const double force = 100.0 * bendOf(def) / (kRadius * kRadius);
    def.forces = {{.node = nodes / 2, .force = {-force, 0, 0}}};
    other.forces = {{.node = 0, .force = {force, 0, 0}}};
    Stage stage;
    stage.add(def);
    stage.add(other);
    stage.step(0.0);
    const double start = linkingNumber(stage.soft(0).x, stage.soft(1).x);
    double worst = 0.0;
    for (int i = 0; i < 1000; ++i) {
        stage.step(1e-3);
        if (i % 20 == 0) worst = std::max(worst, std::abs(linkingNumber(stage.soft(0).x, stage.soft(1).x) - start));
    }
    const double apart = stage.soft(1).x[0].x - stage.soft(0).x[nodes / 2].x;
    verify("rod: two linked rings, pulled with 100 B / R^2 for 1 s: largest change of their linking number", worst,
           1e-6);
    CHECK(std::abs(std::abs(start) - 1.0) < 1e-9);
    // Pulled flat, both together are about twice half their length long.
    CHECK(apart > 1.6 * kPi * kRadius);
    CHECK(apart < 2.0 * kPi * kRadius);
}

} // namespace rod_ring_test
