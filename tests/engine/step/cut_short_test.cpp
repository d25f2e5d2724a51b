// A deadline that ends the solve of touching bodies early in every step must change neither their forces nor tear them.
#include "engine/stage.h"

#include "filasofia/geometry/shapes.h"

namespace cut_short_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

/// Tissue whose steps take more iterations than touching bodies make in any case.
struct Slow {
    double youngModulus, poissonRatio; ///< [Pa] [-]
    int cells;                         ///< through the block's height
    double friction;
    int outOfTime; ///< at least so many steps of 56 are
};
constexpr Slow kStiff{1e5, 0.49, 10, 0.8, 8}, kIncompressible{1e4, 0.499, 8, 0.5, 40};

struct Poke {
    std::vector<double> forces; ///< [N] on the ball, in every step
    std::size_t ruptures = 0;
    int outOfTime = 0; ///< steps
};

/// A ball is pressed 6 mm into a block, which tears at `limit` [Pa], and drawn 8 mm across it. The clock ticks `ticks`
/// times before the deadline.
Poke poke(const Slow& tissue, std::int64_t ticks, double limit = std::numeric_limits<double>::infinity())
{
    constexpr double kDt = 5e-3;
    const int cells = tissue.cells;
    Stage stage;
    physics::SoftBodyDef block{.mesh = shared(boxMesh({2 * cells, cells, 2 * cells}, {0.1, 0.05, 0.1})),
                               .material = physics::FemMaterial{.youngModulus = tissue.youngModulus,
                                                                .poissonRatio = tissue.poissonRatio,
                                                                .tearingThreshold = limit},
                               .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1e-6, 1}}}},
                               .collision = {{}}};
    block.friction = tissue.friction;
    block.dynamicTopology = std::isfinite(limit);
    stage.add(block);
    const auto at = [](double way) {
        return Pose{Vec3{0.046 + std::max(0.0, way - 0.006), 0.0601 - std::min(way, 0.006), 0.053}, {}};
    };
    physics::RigidBodyDef def{.elements = {at(0.0)}, .mesh = geometry::shapes::sphere(0.01), .collision = {{}}};
    def.friction = tissue.friction;
    const BodyId ball = stage.add(def);
    std::int64_t clock = 0;
    Poke out;
    for (int i = 1; i <= 56; ++i) {
        stage.post(physics::SetPose{ball, 0, at(0.05 * kDt * i)});
        const physics::StepBudget budget{.now = [&] { return ++clock; }, .deadline = clock + ticks};
        const physics::StepReport report = stage.world.step({.dt = kDt, .commands = stage.commands, .budget = &budget});
        stage.commands.clear();
        out.ruptures += report.topology.ruptures.size();
        out.outOfTime += report.has(physics::StepFlag::OutOfTime) ? 1 : 0;
        double force = 0.0;
        for (const frame::Contact& contact : stage.world.scene().contactReports) force += contact.normalForce;
        out.forces.push_back(force);
    }
    return out;
}

/// A plate is attached to the top of a block, hard or by springs [N/m], and drawn 10 mm across it.
Poke draw(const Slow& tissue, std::int64_t ticks, double stiffness)
{
    constexpr double kDt = 5e-3, kSpeed = 0.2;
    const int cells = tissue.cells;
    Stage stage;
    const auto at = [](double way) { return Pose{Vec3{0.05 + way, 0.055, 0.05}, {}}; };
    const BodyId plate =
        stage.add(physics::RigidBodyDef{.elements = {at(0.0)}, .mesh = geometry::shapes::box({0.1, 0.01, 0.1})});
    stage.add(physics::SoftBodyDef{
        .mesh = shared(boxMesh({2 * cells, cells, 2 * cells}, {0.1, 0.05, 0.1})),
        .material = physics::FemMaterial{.youngModulus = tissue.youngModulus, .poissonRatio = tissue.poissonRatio},
        .attachments = {
            {.box = geometry::Box{{-1, -1, -1}, {1, 1e-6, 1}}},
            {.box = geometry::Box{{-1, 0.0499, 0.03}, {1, 1, 0.07}}, .stiffness = stiffness, .to = plate}}});
    std::int64_t clock = 0;
    Poke out;
    for (int i = 1; i <= std::lround(0.01 / kSpeed / kDt); ++i) {
        stage.post(physics::SetPose{plate, 0, at(kSpeed * kDt * i)});
        const physics::StepBudget budget{.now = [&] { return ++clock; }, .deadline = clock + ticks};
        const physics::StepReport report = stage.world.step({.dt = kDt, .commands = stage.commands, .budget = &budget});
        stage.commands.clear();
        out.outOfTime += report.has(physics::StepFlag::OutOfTime) ? 1 : 0;
        for (const frame::Attachment& each : stage.world.scene().attachmentReports)
            if (each.to == plate) out.forces.push_back(length(each.force));
    }
    return out;
}

/// The forces of steps that were cut short are within a tenth of the largest one.
void checkClose(const Poke& cut, const Poke& whole)
{
    const double largest = *std::ranges::max_element(whole.forces);
    CHECK(largest > 1.0);
    for (std::size_t i = 0; i < whole.forces.size(); ++i)
        CHECK(std::abs(cut.forces[i] - whole.forces[i]) < 0.1 * largest);
}

constexpr std::int64_t kEnough = 1'000'000;

} // namespace

TEST_CASE("a contact that runs out of time in every step keeps its force")
{
    for (const Slow& tissue : {kStiff, kIncompressible}) {
        const Poke whole = poke(tissue, kEnough), cut = poke(tissue, 1);
        CHECK(whole.outOfTime == 0);
        CHECK(cut.outOfTime >= tissue.outOfTime);
        checkClose(cut, whole);
    }
}

TEST_CASE("an attachment that runs out of time in every step keeps its force")
{
    for (const double stiffness : {1000.0, physics::kHard}) {
        const Poke whole = draw(kIncompressible, kEnough, stiffness), cut = draw(kIncompressible, 1, stiffness);
        CHECK(whole.outOfTime == 0);
        CHECK(cut.outOfTime >= 10);
        checkClose(cut, whole);
    }
}

TEST_CASE("tissue does not tear because its steps run out of time")
{
    constexpr double kMore = 1.2;
    double bears = kIncompressible.youngModulus; // [Pa], down to the least that the tissue bears if it is solved
    while (bears > 1e3 && poke(kIncompressible, kEnough, bears / kMore).ruptures == 0) bears /= kMore;
    CAPTURE(bears);
    CHECK(bears < kIncompressible.youngModulus);
    CHECK(bears > 1e3);
    const Poke cut = poke(kIncompressible, 1, kMore * bears);
    CHECK(cut.outOfTime >= kIncompressible.outOfTime);
    CHECK(cut.ruptures == 0);
}

} // namespace cut_short_test
