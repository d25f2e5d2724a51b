#include "filasofia/core/log.h"
#include "filasofia/engine/contact/missed_contacts.h"

#include "engine/rods.h"

/// Rods whose centre lines cross in a point at the start, as a "+" or a loop in a plane is drawn.
namespace crossing_rods_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

constexpr double kRadius = 0.5e-3;

physics::RodBodyDef rod(std::vector<Vec3> points, double spacing = 2e-3)
{
    physics::RodBodyDef def{.name = "rod", .points = std::move(points), .spacing = spacing, .radius = kRadius};
    def.gravity = false;
    def.collision = physics::RodCollision{};
    return def;
}

/// [m] The least distance of the lines of two rods, or of edges of one that are not near each other along it.
double between(const SoftBody& one, const SoftBody& two)
{
    const bool self = &one == &two;
    double least = std::numeric_limits<double>::infinity();
    const auto far = [&](std::size_t i, std::size_t k) { return !self || std::max(i, k) - std::min(i, k) > 5; };
    for (std::size_t i = 0; i + 1 < one.state.x.size(); ++i)
        for (std::size_t k = 0; k + 1 < two.state.x.size(); ++k)
            if (far(i, k))
                least = std::min(least, length(betweenEdges({one.state.x[i], one.state.x[i + 1]},
                                                            {two.state.x[k], two.state.x[k + 1]})));
    return least;
}

/// What becomes of rods in 50 steps.
struct Parted {
    std::uint32_t flags = 0;
    int iterations = 0;             ///< most of a step
    std::vector<double> apart = {}; ///< [m] between every two, or within the only one
};
Parted part(const std::vector<physics::RodBodyDef>& rods)
{
    Stage stage;
    for (const physics::RodBodyDef& each : rods) stage.add(each);
    Parted out;
    for (int i = 0; i < 50; ++i) {
        const physics::StepReport report = stage.step(1e-3);
        out.flags |= static_cast<std::uint32_t>(report.flags);
        out.iterations = std::max(out.iterations, report.iterations());
    }
    const auto& soft = stage.world.scene().soft;
    for (std::size_t i = 0; i < soft.size(); ++i)
        for (std::size_t k = soft.size() == 1 ? i : i + 1; k < soft.size(); ++k)
            out.apart.push_back(between(soft[i], soft[k]));
    return out;
}

void checkParted(const std::vector<physics::RodBodyDef>& rods)
{
    const Parted parted = part(rods);
    CHECK(parted.flags == 0);
    CHECK(parted.iterations < 100);
    for (const double apart : parted.apart) CHECK(apart > 1.9 * kRadius);
}

} // namespace

TEST_CASE("rods that cross each other in a point part, wherever they cross")
{
    const physics::RodBodyDef along = rod({{-30e-3, 0, 0}, {30e-3, 0, 0}});
    SECTION("at nodes of both") { checkParted({along, rod({{0, 0, -30e-3}, {0, 0, 30e-3}})}); }
    SECTION("between nodes") { checkParted({along, rod({{1e-3, 0, -31e-3}, {1e-3, 0, 31e-3}})}); }
    SECTION("at a node of one") { checkParted({along, rod({{1e-3, 0, -30e-3}, {1e-3, 0, 30e-3}})}); }
    SECTION("at another angle") { checkParted({along, rod({{-20e-3, 5e-3, -31e-3}, {20e-3, -5e-3, 31e-3}})}); }
    SECTION("all three")
    {
        checkParted({along, rod({{0, 0, -30e-3}, {0, 0, 30e-3}}), rod({{0, -30e-3, 0}, {0, 30e-3, 0}})});
    }
}

TEST_CASE("rods that lie in each other part, whichever way they are drawn")
{
    const physics::RodBodyDef along = rod({{-30e-3, 0, 0}, {30e-3, 0, 0}});
    SECTION("the same") { checkParted({along, along}); }
    SECTION("the other way round") { checkParted({along, rod({{30e-3, 0, 0}, {-30e-3, 0, 0}})}); }
    SECTION("in part, at other nodes") { checkParted({along, rod({{-10.7e-3, 0, 0}, {47e-3, 0, 0}})}); }
}

TEST_CASE("a rod that is drawn as a flat figure of eight parts from itself, and is told")
{
    std::string told;
    setLogSink([&](LogLevel, std::string_view line) { told += text(line, "\n"); });
    checkParted({rod({{-20e-3, 0, -20e-3}, {20e-3, 0, 20e-3}, {20e-3, 0, -20e-3}, {-20e-3, 0, 20e-3}})});
    setLogSink({});
    CHECK(told == "body 'rod' starts inside itself, by 1 mm: it is pushed apart, as its radius is 0.5 mm\n");
}

} // namespace crossing_rods_test
