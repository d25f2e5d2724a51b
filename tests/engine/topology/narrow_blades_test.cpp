#include "filasofia/core/log.h"
#include "filasofia/geometry/shapes.h"

#include "engine/stage.h"

namespace narrow_blades_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;
namespace shapes = filasofia::geometry::shapes;

namespace {

constexpr double kLength = 40e-3; // [m] the block along x; its cells are cubes of 2.5 mm

/// A square sheet that slides in its own plane through a block from end to end: it sweeps its width times kLength.
struct Slide {
    Stage stage;
    BodyId blade;
    double area = 0.0; // [m^2] opened
    int pieces = 0;
    int inVain = 0; // strokes
    std::vector<BodyId> idle;
    std::vector<std::string> told;

    /// `another`: it has a blade of group 0, too. `y`, `z` [m]: the middle of the sheet; the block goes from -10 to 10
    /// mm in both.
    Slide(double width, double y, double z, int group = 0, bool another = false)
    {
        setLogSink([&](LogLevel, std::string_view line) { told.emplace_back(line); });
        stage.add(SoftBodyDef{.name = "tissue",
                              .mesh = shapes::block({kLength, 20e-3, 20e-3}, {16, 8, 8}),
                              .material = FemMaterial{.youngModulus = 10e3, .poissonRatio = 0.45},
                              .gravity = false,
                              .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, -9.5e-3, 1}}}},
                              .dynamicTopology = true});
        const auto at = [&](double x) { return Pose{{x, y, z}, {}}; };
        RigidBodyDef tool{.name = "blade", .elements = {at(-35e-3)}};
        for (const int each : {group, 0})
            if (each == group || another)
                tool.collision.push_back({.mesh = shapes::sheet(width, width, {1, 1}), .group = each, .cutting = true});
        if (group == 0) tool.collision.resize(1);
        blade = stage.add(tool);
        for (double x = -35e-3; x < 35e-3; x += 0.2e-3) {
            stage.post(SetPose{blade, 0, at(x)});
            const StepReport report = stage.step(1e-3);
            inVain += report.topology.inVain;
            idle = report.topology.idleBlades;
            for (const Rupture& each : report.topology.ruptures) {
                area += each.area;
                pieces += static_cast<int>(each.detached.size());
            }
        }
        setLogSink({});
    }
    [[nodiscard]] std::size_t saidThat(const std::string& words) const
    {
        return static_cast<std::size_t>(
            std::ranges::count_if(told, [&](const std::string& line) { return line.find(words) != line.npos; }));
    }
};

} // namespace

TEST_CASE("a blade that slides through tissue opens no more than it sweeps, however narrow it is")
{
    // They opened 779, 891, 630 and 881 mm^2 where 160, 160, 160 and 240 were swept.
    for (const auto& [width, y, z] :
         {std::tuple{4e-3, 1.5e-3, 1e-3}, {4e-3, 1.5e-3, -3.3e-3}, {4e-3, -1e-3, 4.2e-3}, {6e-3, 0.9e-3, 1e-3}}) {
        const Slide slide(width, y, z);
        INFO(1e3 * width << " " << 1e3 * y << " " << 1e3 * z);
        CHECK(slide.area <= 1.02 * width * kLength);
        CHECK(slide.area >= 0.3 * width * kLength);
        CHECK(slide.pieces == 0);
        CHECK(slide.saidThat("opened nothing") == 0);
        CHECK(slide.inVain == 0);
    }
}

TEST_CASE("a cut two or three elements wide opens, also where all its nodes are on its rim")
{
    // None of the first three opened, as nothing parts nodes on a rim. The last two had 302 and 307 of 400 mm^2.
    for (const auto& [width, y, z, share] : {std::tuple{6e-3, 2.39e-3, -1.4e-3, 0.4},
                                             {6e-3, 0.0, 1e-3, 0.4},
                                             {7e-3, 2.35e-3, 1.47e-3, 0.35},
                                             {10e-3, 1.84e-3, 1.62e-3, 0.75},
                                             {10e-3, 4.66e-3, -0.11e-3, 0.85}}) {
        const Slide slide(width, y, z);
        INFO(1e3 * width << " " << 1e3 * y << " " << 1e3 * z);
        CHECK(slide.area >= share * width * kLength);
        CHECK(slide.area <= 1.02 * width * kLength);
        CHECK(slide.pieces == 0);
    }
}

TEST_CASE("a cut that is too small for the elements is told, and so is a blade that no tissue has the group of")
{
    const Slide thin(1e-3, -0.3e-3, 0.42e-3);
    CHECK(thin.area == 0.0);
    CHECK(thin.saidThat("opened nothing: the cut was smaller than elements of") == 1);
    CHECK(thin.inVain > 0);
    CHECK(thin.idle.empty());
    const Slide idle(20e-3, 0.1e-3, 0.0, 3);
    CHECK(idle.area == 0.0);
    CHECK(idle.saidThat("no body that may be cut has collision group 3: its blade cuts nothing") == 1);
    CHECK(idle.idle == std::vector{idle.blade});
    CHECK(idle.inVain == 0);
    CHECK(thin.saidThat("its blade cuts nothing") == 0);
    const Slide one(20e-3, 0.1e-3, 0.0, 3, true); // one of its two blades cuts
    CHECK(one.area > 0.0);
    CHECK(one.saidThat("its blade cuts nothing") == 0);
    CHECK(one.idle.empty());
}

TEST_CASE("a piece that does not exist is not removed, and that is told")
{
    Slide slide(20e-3, 0.1e-3, 0.0);
    std::vector<std::string> told;
    setLogSink([&](LogLevel, std::string_view line) { told.emplace_back(line); });
    slide.stage.post(RemovePiece{BodyId{1}, 7});
    CHECK(slide.stage.step(1e-3).topology.noPiece == 1);
    setLogSink({});
    REQUIRE(told.size() == 1);
    CHECK_THAT(told[0], Catch::Contains("RemovePiece: piece 7 does not exist"));
}

} // namespace narrow_blades_test
