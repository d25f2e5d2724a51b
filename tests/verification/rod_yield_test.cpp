#include "filasofia/engine/soft/rod_system.h"

#include "verification/rods.h"

#include <utility>

namespace rod_yield_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr double kLength = 0.2, kYieldStrain = 2e-3;
constexpr int kEdges = 50;

/// A rod along x whose first edge is pinned. It yields at a curvature of 2 / m.
RodBodyDef pinnedRod()
{
    RodBodyDef def = clampedRod(kLength, kEdges);
    def.yieldStrain = kYieldStrain;
    def.rayleigh.mass = 200.0;
    return def;
}

/// Places all nodes of a rod on arcs that begin at its pinned edge. Every edge keeps its length, and every joint has
/// the same curvature; that beside the clamp stands for half an edge.
class Bending {
public:
    explicit Bending(const RodBodyDef& def = pinnedRod())
    {
        stage.add(def);
        stage.step(0.0);
    }

    /// In small steps, to a curvature [1/m]; returns the work [J] that it took: minus that of the rod's forces.
    double bendTo(double curvature, int steps)
    {
        double work = 0.0;
        const double from = std::exchange(curvature_, curvature), l = kLength / kEdges;
        for (int i = 1; i <= steps; ++i) {
            SoftState& state = stage.soft();
            const std::vector<Vec3> forces = forcesNow(), before = state.x;
            const double turn = l * (from + (curvature - from) * i / steps);
            for (std::size_t k = 2; k < state.x.size(); ++k) {
                const double angle = (static_cast<double>(k) - 1.5) * turn;
                state.x[k] = state.x[k - 1] + l * Vec3{std::cos(angle), std::sin(angle), 0};
            }
            for (auto* list : {&state.v, &state.dv}) std::ranges::fill(*list, Vec3{});
            for (auto* list : {&state.rod.spins, &state.rod.tensions}) std::ranges::fill(*list, 0.0);
            stage.step(1e-9);
            const std::vector<Vec3> after = forcesNow();
            for (std::size_t k = 0; k < before.size(); ++k)
                work -= 0.5 * dot(forces[k] + after[k], stage.soft().x[k] - before[k]);
        }
        return work;
    }

    /// The curvature [1/m] of a joint, and what of it is plastic.
    double curvatureAt(std::size_t joint)
    {
        const RodPlace at = placeAt(stage.soft().rod, stage.soft().x, joint);
        return length(rodCurvature(at.x[1] - at.x[0], at.x[2] - at.x[1])) / (kLength / kEdges);
    }
    double plasticAt(std::size_t joint)
    {
        const auto& [first, second] = stage.soft().rod.plastic.at(joint);
        return 0.5 * (std::hypot(first[0], first[1]) + std::hypot(second[0], second[1])) / (kLength / kEdges);
    }

    Stage stage;

private:
    std::vector<Vec3> forcesNow()
    {
        std::vector<Vec3> forces(stage.model().rest.size());
        addRodForces(stage.model(), stage.soft(), std::vector<bool>(forces.size(), true), forces);
        return forces;
    }

    double curvature_ = 0.0;
};

/// kb over the length of a joint, at a curvature of the arc.
double discrete(double curvature)
{
    const double l = kLength / kEdges;
    return 2.0 * std::tan(0.5 * curvature * l) / l;
}

} // namespace

TEST_CASE("a rod that is bent past its yield and let go keeps the curvature beyond its elastic one")
{
    constexpr double yield = kYieldStrain / 1e-3; // [1/m]
    for (const double times : {1.5, 3.0, 8.0}) {
        Bending bent;
        bent.bendTo(times * yield, 50);
        // What springs back at once overshoots, and yields the other way: the most of it is led.
        bent.bendTo((times - 0.7) * yield, 1);
        settle(bent.stage, 0.02, 4000);
        double worst = 0.0;
        for (std::size_t j = 1; j < bent.stage.model().rod.joints.size(); ++j)
            worst = std::max(worst, std::abs(bent.curvatureAt(j) / (discrete(times * yield) - yield) - 1.0));
        verify(text("rod: bent to ", times,
                    " times its yield curvature and let go: largest relative error of what is left anywhere"),
               worst, 1e-3);
    }
}

TEST_CASE("a rod that is bent to less than its yield comes back, and nothing of it is plastic")
{
    Bending bent;
    bent.bendTo(0.99 * kYieldStrain / 1e-3, 10);
    const auto plastic = [&] { return bent.stage.soft().rod.plastic; };
    CHECK(plastic() == std::vector<RodCurvature>(kEdges));
    bent.bendTo(0.3 * kYieldStrain / 1e-3, 1);
    settle(bent.stage, 0.02, 4000);
    CHECK(plastic() == std::vector<RodCurvature>(kEdges));
    CHECK(distance(bent.stage.soft().x.back(), bent.stage.model().rest.back()) < 1e-6 * kLength);
}

TEST_CASE("the work that bends a rod plastically is moment times plastic curvature")
{
    const double yield = kYieldStrain / 1e-3, most = 4.0 * yield, left = discrete(most) - yield;
    Bending bent;
    // The last half of its last edge does not bend.
    const double length = kLength - 0.5 * kLength / kEdges;
    const double moment = bendOf(pinnedRod()) * yield, elastic = 0.5 * moment * yield * length;
    const double in = bent.bendTo(most, 4000);
    verify("rod: bent to 4 times its yield curvature: relative error of the work, elastic + moment x plastic curvature",
           std::abs(in / (elastic + moment * left * length) - 1.0), 2e-3);
    const double out = bent.bendTo(left, 1000); // until it bears no moment
    verify("rod: bent to 4 times its yield curvature and back: relative error of the work that is lost",
           std::abs((in + out) / (moment * left * length) - 1.0), 2e-3);
    bent.bendTo(0.0, 1000); // on the way it yields again
    verify("rod: bent back until straight: relative error of the plastic curvature, which is the elastic one",
           std::abs(bent.plasticAt(kEdges / 2) / yield - 1.0), 1e-9);
}

TEST_CASE("a rod that hardens bears the moment of its bilinear law")
{
    RodBodyDef def = pinnedRod();
    def.hardening = 0.25;
    const double yield = kYieldStrain / 1e-3;
    for (const double times : {2.0, 5.0}) {
        Bending bent(def);
        bent.bendTo(times * yield, 100);
        // M = B yield + 0.25 B (k - yield), and M = B (k - plastic); bent back, it yields at M - 2 B yield
        const double beyond = discrete(times * yield) - yield;
        verify(text("rod: hardening of 0.25, bent to ", times,
                    " times its yield curvature: relative error of the plastic curvature"),
               std::abs(bent.plasticAt(kEdges / 2) / (0.75 * beyond) - 1.0), 1e-9);
        const double before = bent.plasticAt(kEdges / 2);
        bent.bendTo((times - 1.99) * yield, 100);
        CHECK(bent.plasticAt(kEdges / 2) == before);
        bent.bendTo((times - 2.1) * yield, 100);
        CHECK(bent.plasticAt(kEdges / 2) < before);
    }
}

TEST_CASE("a twisted wire that random forces bend here and there dissipates in every step and stays finite")
{
    RodBodyDef def = clampedRod(0.1, 40);
    def.yieldStrain = 1e-3;
    def.rayleigh = {5.0, 0.0};
    def.twist = 3.0;
    Stage stage;
    stage.add(def);
    stage.step(0.0);
    std::mt19937 random(4);
    double dissipated = 0.0;
    for (int i = 0; i < 2000; ++i) {
        if (i % 50 == 0) stage.post(SetForces{BodyId{1}, {{.node = 41, .force = randomVec3(random, 0.02)}}});
        const std::vector<RodCurvature> before = stage.soft().rod.plastic;
        stage.step(1e-3);
        const RodState& rod = stage.soft().rod;
        const std::vector<RodJoint> joints = stiffJoints(stage.model().rod, stage.model().pins.hard);
        double lost = 0.0;
        for (std::size_t j = 0; j < joints.size(); ++j) {
            const RodCurvature now = curvatureInMaterial(placeAt(rod, stage.soft().x, j));
            for (std::size_t e = 0; e < 2; ++e)
                for (std::size_t a = 0; a < 2; ++a)
                    lost += 0.5 * joints[j].bend * (now[e][a] - rod.plastic[j][e][a]) *
                            (rod.plastic[j][e][a] - before[j][e][a]);
        }
        REQUIRE(lost >= 0.0);
        dissipated += lost;
        for (Vec3 x : stage.soft().x) REQUIRE(isFinite(x));
    }
    CHECK(dissipated > 0.0);
}

} // namespace rod_yield_test
