#include "filasofia/engine/body/plasticity.h"

#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/body/tissue.h"
#include "filasofia/geometry/shapes.h"

#include "engine/elastic/laws.h"
#include "engine/stage.h"

namespace plasticity_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr double kYield = 2e3, kYoung = 20e3, kNu = 0.3;

SoftBodyDef bar(const ElasticLaw& law, double yield, bool assembled = false)
{
    return {.name = "bar",
            .mesh = geometry::shapes::block({0.01, 0.01, 0.02}, {2, 2, 4}),
            .material = FemMaterial{.youngModulus = kYoung, .poissonRatio = kNu, .law = law, .yieldStress = yield},
            .gravity = false,
            .solver = ConjugateGradient{.tolerance = 1e-4, .assembled = assembled}};
}

/// Moves every node by an affine map in the next step, which has next to no duration.
void deform(Stage& stage, const Mat3& f)
{
    SoftState& state = stage.soft();
    for (std::size_t i = 0; i < state.x.size(); ++i) state.x[i] = f * stage.model().rest[i];
    for (auto* list : {&state.v, &state.dv, &state.residual}) std::ranges::fill(*list, Vec3{});
    stage.step(1e-9);
}

Mat3 stressNow(Stage& stage, std::size_t e = 0)
{
    const FemElement& element = stage.model().elements[e];
    return endStress(stage.model(), stage.soft(), e, gradient(element, cornersOf(element.nodes, stage.soft().x)));
}

} // namespace

TEST_CASE("plasticity: beyond the yield stress tissue bears the yield stress, with every law and either solver")
{
    for (const auto& [name, law] : everyLaw())
        for (const bool assembled : {false, true}) {
            INFO(name);
            Stage stage;
            stage.add(bar(law, kYield, assembled));
            stage.step(1e-9);
            const Mat3 turn = toMat3(axisAngle({1, 2, 3}, 0.7));
            deform(stage, turn * Mat3::diagonal({0.98, 0.98, 1.05})); // not yet
            CHECK(stage.model().elements[0].plastic == Mat3::identity());
            deform(stage, turn * Mat3{{{0.95, 0.02, 0}, {0, 0.93, 0.1}, {0, 0, 1.2}}});
            for (std::size_t e = 0; e < stage.model().elements.size(); ++e) {
                const FemElement& element = stage.model().elements[e];
                CHECK(vonMises(stressNow(stage, e)) == Approx(kYield).epsilon(2e-3));
                CHECK(determinant(element.plastic) == Approx(1.0));
                CHECK(element.volume == Approx(volumeOf(cornersOf(element.nodes, stage.model().rest))));
            }
        }
}

TEST_CASE("plasticity: what has flowed stays, and Reset and SetMaterial heal it")
{
    Stage stage;
    const BodyId id = stage.add(bar(NeoHookean{}, kYield));
    stage.step(1e-9);
    deform(stage, Mat3::diagonal({0.9, 0.9, 1.3}));
    const std::vector<Vec3> fresh = stage.model().rest;
    stage.run(2000, 0.005);
    const auto height = [](const std::vector<Vec3>& x) {
        double low = 1.0, high = -1.0;
        for (const Vec3& each : x) low = std::min(low, each.z), high = std::max(high, each.z);
        return high - low;
    };
    CHECK(height(stage.soft().x) > 1.1 * 0.02);
    CHECK(meshVolume(stage.model(), stage.soft().x) == Approx(meshVolume(stage.model(), fresh)).epsilon(1e-3));
    stage.post(Reset{});
    stage.step(0.0);
    CHECK(stage.model().elements[0].plastic == Mat3::identity());
    stage.run(10, 0.005);
    CHECK(height(stage.soft().x) == Approx(0.02).epsilon(1e-6));
    deform(stage, Mat3::diagonal({0.9, 0.9, 1.3}));
    CHECK(stage.model().elements[0].plastic != Mat3::identity());
    stage.post(SetMaterial{id, FemMaterial{.youngModulus = kYoung, .poissonRatio = kNu}, {}});
    stage.run(2000, 0.005);
    CHECK(stage.model().elements[0].plastic == Mat3::identity());
    CHECK(height(stage.soft().x) == Approx(0.02).epsilon(1e-3));
}

TEST_CASE("plasticity: a region yields, and what lies beside it does not")
{
    SoftBodyDef def = bar(NeoHookean{}, std::numeric_limits<double>::infinity());
    std::get<FemMaterial>(def.material).regions = {
        {.where = geometry::Box{{-1, -1, 0}, {1, 1, 1}}, .yieldStress = kYield}};
    Stage stage;
    stage.add(def);
    stage.step(1e-9);
    deform(stage, Mat3::diagonal({0.9, 0.9, 1.3}));
    int flowed = 0;
    for (const FemElement& each : stage.model().elements) {
        const Corners rest = cornersOf(each.nodes, stage.model().rest);
        const bool upper = rest[0].z + rest[1].z + rest[2].z + rest[3].z > 0.0;
        CHECK((each.plastic != Mat3::identity()) == upper);
        flowed += upper ? 1 : 0;
    }
    CHECK(flowed == static_cast<int>(stage.model().elements.size()) / 2);
}

TEST_CASE("plasticity: pressed flat, wound up and inside out, everything stays finite and usable")
{
    std::mt19937 random(1);
    for (const auto& [name, law] : everyLaw()) {
        INFO(name);
        Stage stage;
        stage.add(bar(law, 100.0));
        stage.step(1e-9);
        for (int i = 0; i < 30; ++i) {
            Mat3 f = randomMat3(random, 1.5);
            if (i % 3 == 0) f = Mat3::diagonal({3.0, 1.0, 1e-3});
            deform(stage, f);
            stage.run(3, 0.005);
            for (const FemElement& each : stage.model().elements) {
                CHECK(frobeniusNorm(each.plastic) < 5.0);
                CHECK(each.volume > 0.0);
            }
            for (const Vec3& x : stage.soft().x) CHECK(isFinite(x));
        }
    }
}

} // namespace plasticity_test
