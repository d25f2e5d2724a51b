#include "apps/hysteroscopy/theatre.h"

using namespace filasofia;

namespace hysteroscopy {

SimulationDef theatre()
{
    // Everything floats in the fluid, so there is no gravity. A step may take longer than the time it simulates,
    // because tissue that is solved badly tears by that alone.
    return {.physics = {.gravity = {}, .contact = ExactContact{.tolerance = 2e-2}, .deadline = 5e-3},
            .window = {"Hysteroscopy", 720, 720},
            .look = {.mouse = false, .keys = false}};
}

EndoscopeDef scopeOf(std::vector<int> groups)
{
    return {.name = "hysteroscope",
            .pose = {{0, -0.1, 0}, {}},
            .groups = std::move(groups),
            .intensity = 2.0,
            .surroundings = {.intensity = 300.0,
                             .above = {0.55, 0.36, 0.32},
                             .below = {0.45, 0.25, 0.21},
                             .lampStrength = 1.0,
                             .background = {0.03, 0.006, 0.005}}};
}

prefab::ScopeHandsDef handsOf(const Training& training, double mostReach)
{
    return {.fulcrum = kFulcrum,
            .up = {0, 0, 1},
            .start = {{0, 1, 0}, -39_mm, 0, -6_mm},
            .leastDepth = -60_mm,
            .mostDepth = 36_mm,
            .mostReach = mostReach,
            .strength = training.rules(kRules[training.difficulty]).strength,
            .handle = training.devices > 0};
}

MetricTrackerDef observedIn(const Training& training, const TrackedBody& tool, BodyId scope, const std::string& target)
{
    MetricTrackerDef out{.bodies = {tool, {.body = scope, .role = Role::Scope, .element = Endoscope::kCamera}},
                         .file = training.file};
    out.session = {.trainee = training.trainee,
                   .task = training.task("hysteroscopy " + kCases[static_cast<std::size_t>(training.caseIndex)]),
                   .software = "Filasofia",
                   .seed = static_cast<std::uint64_t>(training.seed),
                   .forceLimit = training.rules(kRules[training.difficulty]).warning,
                   .fieldOfView = EndoscopeDef{}.fieldOfView,
                   .targets = {target},
                   .watched = {EventKind::Perforation, EventKind::Unfinished}};
    return out;
}

Vec3 tipOf(const frame::Frame& now, BodyId scope) { return now.rigidBody(scope)->poses[0].position; }

std::vector<TaskStep> wayIn(const Patient& patient, BodyId scope, const char* find)
{
    using frame::Frame;
    const auto to = [](Vec3 place) { return [place](const Frame&) { return std::optional(place); }; };
    const Vec3 goal = patient.middle;
    return {{.name = "enter",
             .instruction = "Enter through the external os",
             .done = [=](const Frame& now) { return tipOf(now, scope).y > 3_mm; },
             .target = to({})},
            {.name = "canal",
             .instruction = "Follow the canal into the cavity",
             .done = [=](const Frame& now) { return tipOf(now, scope).y > 29_mm; },
             .target = to({0, 32_mm, 0})},
            {.name = "find",
             .instruction = find,
             .done = [=](const Frame& now) { return distance(tipOf(now, scope), goal) < 20_mm; },
             .target = to(goal)}};
}

std::string millilitres(double volume) { return text(std::round(volume * 1e8) / 100.0, " ml"); }

} // namespace hysteroscopy
