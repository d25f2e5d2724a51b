#include "apps/filasofia/bench/bench.h"
#include "filasofia/core/text.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/runtime/clock.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace filasofia::app {
namespace {

using nlohmann::json;
using runtime::Spread;

constexpr double kRodStep = 1e-3;      ///< [s]
constexpr double kRodEdge = 1e-3;      ///< [m] between nodes
constexpr double kRodRadius = 0.25e-3; ///< [m]

enum class Where { Hanging, Floor, Coil };

/// One rod, and what it does.
struct RodCase {
    std::string name;
    Where where = Where::Hanging;
    int nodes = 200;
};

struct RodTimes {
    Spread step = {};      ///< [s]
    double contacts = 0.0; ///< mean number of contacts that push
    double self = 0.0;     ///< the same of the rod with itself
    double iterations = 0.0;
    std::uint32_t flags = 0;
};

physics::RodBodyDef rodOf(const RodCase& each)
{
    physics::RodBodyDef def{.name = "thread", .radius = kRodRadius, .youngModulus = 1e7, .straight = false};
    def.rayleigh.mass = 5.0; // so that it rests
    // A coil goes around three times, each time above itself; on the floor it is a spiral.
    const double radius = each.where == Where::Coil ? 0.01 : 0.02;
    for (int i = 0; i < each.nodes; ++i) {
        const double s = kRodEdge * i, angle = s / radius;
        const double inwards = each.where == Where::Floor ? 0.8e-3 * angle / (2.0 * std::numbers::pi) : 0.0;
        const double height = each.where == Where::Coil ? 2.4 * kRodRadius * angle / (2.0 * std::numbers::pi) : 0.0;
        const double r = radius + (each.nodes > 400 ? 0.02 : 0.0) - inwards;
        if (each.where == Where::Hanging)
            def.points.push_back({s, 0, 0});
        else
            def.points.push_back({r * std::cos(angle), 1.2 * kRodRadius + height, r * std::sin(angle)});
    }
    if (each.where == Where::Hanging)
        def.attachments = {{.nodes = {0, 1}}};
    else
        def.collision = physics::RodCollision{};
    return def;
}

RodTimes timeRod(const RodCase& each, int steps)
{
    const auto engine = engine::makeNativeEngine({.period = kRodStep, .threads = 1});
    std::vector<physics::Command> commands;
    commands.emplace_back(physics::SetGravity{{0, -9.81, 0}});
    const auto add = [&](const physics::BodyDef& def, std::uint32_t id) {
        const auto shared = std::make_shared<const physics::BodyDef>(def);
        commands.emplace_back(physics::AddBody{BodyId{id}, shared, engine->build(*shared), AttachmentId{1}});
    };
    add(rodOf(each), 1);
    if (each.where != Where::Hanging)
        add(physics::RigidBodyDef{.name = "floor",
                                  .elements = {{{0, -5e-3, 0}, {}}},
                                  .mesh = geometry::shapes::box({0.4, 0.01, 0.4}),
                                  .collision = {{}}},
            2);
    engine->step({.dt = 0.0, .commands = commands});
    commands.clear();
    for (int i = 0; i < steps; ++i) engine->step({.dt = kRodStep, .commands = commands});

    const auto now = runtime::steadyClock().now;
    RodTimes times;
    std::vector<double> costs;
    frame::Frame frame;
    for (int i = 0; i < steps; ++i) {
        const runtime::Nanoseconds begun = now();
        const physics::StepReport report = engine->step({.dt = kRodStep, .commands = commands});
        costs.push_back(1e-9 * static_cast<double>(now() - begun));
        times.flags |= report.flags;
        times.iterations += static_cast<double>(report.solves.front().iterations) / steps;
        engine->capture(frame);
        for (const frame::Contact& contact : frame.contacts) {
            if (!(contact.normalForce > 0.0)) continue;
            times.contacts += 1.0 / steps;
            times.self += contact.first == contact.second ? 1.0 / steps : 0.0;
        }
    }
    times.step = runtime::spreadOf(costs);
    return times;
}

} // namespace

json benchRod(bool quick)
{
    const std::vector<RodCase> cases{{"hangs by one end", Where::Hanging, 200},
                                     {"lies on a floor", Where::Floor, 200},
                                     {"lies on a floor and itself", Where::Coil, 200},
                                     {"hangs by one end", Where::Hanging, 1000},
                                     {"lies on a floor", Where::Floor, 1000}};
    std::printf("one thread, steps of 1 ms\n\n%5s  %-28s %8s %8s %9s %6s %6s\n", "nodes", "it", "step ms", "p99",
                "contacts", "self", "iter");
    json cells = json::array();
    std::vector<RodTimes> all;
    for (const RodCase& each : cases) {
        const RodTimes& times = all.emplace_back(timeRod(each, quick ? 300 : 1000));
        std::printf("%5d  %-28s %8.3f %8.3f %9.0f %6.0f %6.1f\n", each.nodes, each.name.c_str(),
                    1e3 * times.step.median, 1e3 * times.step.p99, times.contacts, times.self, times.iterations);
        std::fflush(stdout);
        cells.push_back({{"rod", each.name},
                         {"nodes", each.nodes},
                         {"step_s", spreadToJson(times.step)},
                         {"contacts_mean", times.contacts},
                         {"self_contacts_mean", times.self},
                         {"iterations_mean", times.iterations},
                         {"flags", times.flags}});
    }
    const auto verdict = [&](const std::string& limit, std::size_t which, double most) {
        return Verdict{limit, all[which].step.median <= most, text(rounded(1e3 * all[which].step.median, 1000), " ms")};
    };
    const std::vector<Verdict> verdicts{verdict("200 nodes that touch themselves take at most 0.3 ms", 2, 0.3e-3),
                                        verdict("1,000 nodes take at most 1.5 ms", 3, 1.5e-3)};
    return {{"bench", "rod"}, {"quick", quick}, {"cells", cells}, {"limits", printVerdicts(verdicts)}};
}

} // namespace filasofia::app
