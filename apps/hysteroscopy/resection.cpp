#include "apps/hysteroscopy/resection.h"

#include "apps/hysteroscopy/fluid.h"
#include "apps/hysteroscopy/motion.h"
#include "apps/hysteroscopy/theatre.h"

#include <filasofia/core/disjoint_sets.h>
#include <filasofia/geometry/distance.h>
#include <filasofia/geometry/surface.h>

#include <set>

using namespace filasofia;

namespace hysteroscopy {
namespace {

constexpr double kDensity = 1000.0; ///< [kg/m^3], all tissue here
constexpr double kFloats = 0.6;     ///< [s], for which a chip is seen
constexpr double kEvery = 5e-3;     ///< [s], between two looks at the wire
constexpr double kTold = 0.1;       ///< [s], between two events of what is left, or burnt

TetMesh meshOf(Simulation& sim, BodyId body)
{
    return physics::worldMesh(std::get<SoftBodyDef>(*sim.physics().def(body)));
}
/// [m^3] What is above the wall, by the middles of the tetrahedra.
double volumeAbove(const TetMesh& mesh, const Patient& patient)
{
    double sum = 0.0;
    for (const auto& [a, b, c, d] : mesh.tetrahedra) {
        const auto at = [&](int node) { return mesh.nodes[static_cast<std::size_t>(node)]; };
        const Vec3 middle = 0.25 * (at(a) + at(b) + at(c) + at(d));
        if (dot(middle - patient.pose.position, patient.normal) > 0.0)
            sum += geometry::signedVolume(at(a), at(b), at(c), at(d));
    }
    return sum;
}

/// Where the root is now: its place on the wall and what its base has moved by.
Vec3 rootOf(const Patient& patient, const std::vector<Vec3>& before, const std::vector<Vec3>& now)
{
    Vec3 moved;
    for (const int node : patient.base)
        moved += now[static_cast<std::size_t>(node)] - before[static_cast<std::size_t>(node)];
    return patient.pose.position + 1.0 / static_cast<double>(patient.base.size()) * moved;
}

/// Where the surface is now, but for chips that have come off.
std::vector<Vec3> rootedSurface(const frame::SoftBodyFrame& myoma, const std::vector<int>& base)
{
    if (!myoma.boundary || myoma.boundary->triangles.empty()) return myoma.positions;
    DisjointSets parts(myoma.positions.size());
    for (const auto& [a, b, c] : myoma.boundary->triangles) {
        parts.join(a, b);
        parts.join(a, c);
    }
    std::set<int> rooted;
    for (const int node : base) rooted.insert(parts.find(node));
    std::vector<Vec3> out;
    for (const auto& triangle : myoma.boundary->triangles)
        for (const int node : triangle)
            if (rooted.contains(parts.find(node))) out.push_back(myoma.positions[static_cast<std::size_t>(node)]);
    return out;
}

/// `most` [-]: the share of what is above the wall that may be left.
std::vector<TaskStep> stepsOf(const Patient& patient, BodyId scope, const Chips& chips, double most)
{
    using frame::Frame;
    const auto step = [&](const char* name, const char* instruction, auto when, Vec3 target) {
        return TaskStep{.name = name, .instruction = instruction, .done = when, .target = [=](const Frame&) {
                            return std::optional(target);
                        }};
    };
    const Vec3 goal = patient.middle;
    std::vector<TaskStep> steps = wayIn(patient, scope, "Find the myoma and come up to it");
    steps.insert(steps.end(), {step(
                                   "first chip", "Push the loop out beyond the myoma, cut, and draw it towards you",
                                   [&chips](const Frame&) { return chips.count() > 0; }, goal),
                               step(
                                   "resect", "Shave the myoma off, chip by chip, and spare the wall",
                                   [&chips, most](const Frame&) { return chips.left() < most; }, goal),
                               step(
                                   "leave", "Draw the loop in and leave",
                                   [=](const Frame& now) { return tipOf(now, scope).y < -1_mm; }, Vec3())});
    return steps;
}

std::string percent(double share) { return text(std::lround(100 * share), " %"); }
std::string squareMillimetres(double area) { return text(std::lround(1e6 * area), " mm^2"); }
std::string millimetres(double length) { return text(std::round(length * 1e4) / 10.0, " mm"); }

} // namespace

Chips::Chips(Simulation& sim, const Patient& patient, BodyId myoma)
    : sim_(sim), myoma_(myoma), whole_(volumeAbove(meshOf(sim, myoma), patient))
{
    sim.on<CutEvent>([this](const CutEvent& cut) { take(cut); });
    sim.everyStep([this](double time) { rinse(time); });
}

double Chips::left() const { return std::max(1.0 - removed_ / whole_, 0.0); }

void Chips::take(const CutEvent& cut)
{
    if (cut.rupture.body != myoma_) return;
    for (const physics::LoosePiece& each : cut.rupture.detached) {
        const double volume = each.mass / kDensity;
        if (volume > 0.5 * whole_) continue; // a loop is too small for that: the myoma came off as a whole
        removed_ += volume;
        ++count_;
        if (onChip) onChip(volume);
        const std::lock_guard lock(mutex_);
        floating_.push_back({.piece = each.piece, .until = sim_.physics().latest()->time + kFloats});
    }
}

void Chips::rinse(double time)
{
    const std::lock_guard lock(mutex_);
    std::erase_if(floating_, [&](const Chip& each) {
        if (time < each.until) return false;
        sim_.physics().removePiece(myoma_, each.piece);
        return true;
    });
}

WallInjury::WallInjury(Simulation& sim, BodyId wall, const WireLoop& loop, double deep,
                       std::function<void(double)> mistaken)
    : sim_(sim), wall_(wall), loop_(loop), deep_(deep), mistaken_(std::move(mistaken)), mesh_(meshOf(sim, wall)),
      skin_(geometry::extractSurface(mesh_).mesh.triangles)
{
    sim.everyStep([this](double time) { look(time); });
}

/// [m] 0: it is not in the wall.
double WallInjury::depthIn(const std::vector<Vec3>& wall, Vec3 place) const
{
    const auto at = [&](int node) { return wall[static_cast<std::size_t>(node)]; };
    using geometry::signedVolume;
    const bool inside = std::ranges::any_of(mesh_.tetrahedra, [&](const auto& corners) {
        const Vec3 a = at(corners[0]), b = at(corners[1]), c = at(corners[2]), d = at(corners[3]);
        return signedVolume(place, b, c, d) >= 0.0 && signedVolume(a, place, c, d) >= 0.0 &&
               signedVolume(a, b, place, d) >= 0.0 && signedVolume(a, b, c, place) >= 0.0;
    });
    if (!inside) return 0.0;
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& [a, b, c] : skin_)
        nearest = std::min(nearest, geometry::nearestOnTriangle(place, at(a), at(b), at(c)).squaredDistance);
    return std::sqrt(nearest);
}

double WallInjury::depthAt(Vec3 place) const
{
    const frame::FrameRef frame = sim_.physics().latest();
    return depthIn(frame->softBody(wall_)->positions, place);
}

void WallInjury::look(double time)
{
    const frame::FrameRef frame = sim_.physics().latest();
    if (time < nextLook_ || !frame) return;
    nextLook_ = time + kEvery;
    const double active = sim_.energy(loop_.body(), WireLoop::kCuts).active;
    const bool live = active > std::exchange(active_, active);
    const Pose& pose = frame->rigidBody(loop_.body())->poses[0];
    std::vector<Vec3> wire;
    for (const Vec3& each : loop_.line()) wire.push_back(transform(pose, each));
    const std::vector<Vec3> last = std::exchange(wire_, wire);
    if (!live) {
        within_ = false;
        return;
    }
    const std::vector<Vec3>& wall = frame->softBody(wall_)->positions;
    double deepest = 0.0, swept = 0.0;
    for (std::size_t i = 1; i < wire.size(); ++i) {
        const double depth = depthIn(wall, 0.5 * (wire[i - 1] + wire[i]));
        deepest = std::max(deepest, depth);
        if (depth > 0.0 && last.size() == wire.size())
            swept += length(cross(wire[i] - wire[i - 1], 0.5 * (wire[i - 1] + wire[i] - last[i - 1] - last[i])));
    }
    burnt_ = burnt_ + swept;
    deepest_ = std::max(deepest_.load(), deepest);
    const bool before = std::exchange(within_, deepest > deep_);
    if (before || !within_) return;
    ++mistakes_;
    mistaken_(deepest);
}

int resection(const Training& training, const Patient& patient)
{
    const Rules rules = training.rules(kRules[training.difficulty]);
    const MyomaRules myoma = training.rules(MyomaRules{});
    Simulation sim(theatre());
    const Bodies bodies = addPatient(sim, patient, training);
    Fluid fluid(sim, bodies, rules.pressure, 5e-5);
    sim.burn(bodies.polyp, {.depth = 0.5_mm});
    // The arms lie on both sides of the optic, so the loop is drawn into the sheath.
    EndoscopeDef sheath = scopeOf({ScopeWall, ScopePolyp});
    sheath.channel = {{0, 0.7_mm, 2.3_mm}, {}};
    Endoscope scope(sim, sheath);
    WireLoop loop(sim, {.pose = scope.channel(),
                        .width = 4.8_mm,
                        .depth = 3.1_mm,
                        .cutting = 20.0,
                        .groups = {LoopWall, LoopMyoma},
                        .material = MetalMaterial{.roughness = 0.5}});
    ScopeHands hands(sim, scope, loop, handsOf(training, 25_mm));
    if (training.devices > 0) sim.add(HapticInterfaceDef{.name = "hand", .body = hands.handle()});

    Chips chips(sim, patient, bodies.polyp);
    MetricTrackerDef observed =
        observedIn(training, {.body = loop.body(), .tip = {0, -loop.def().depth, 0}}, scope.body(), "myoma");
    observed.session.watched.insert(observed.session.watched.end(),
                                    {EventKind::Mistake, EventKind::Removed, EventKind::Residual, EventKind::Burn});
    const WallInjury* watched = nullptr;
    const PerforationWatch* perforations = nullptr;
    const auto results = [&](const TaskProgress&) {
        return std::vector<ResultLine>{{"Left of the myoma", percent(chips.left())},
                                       {"Deepest in the wall", millimetres(watched->deepest())},
                                       {"Wall burnt", squareMillimetres(watched->burnt())},
                                       {"Perforations", text(perforations->count())},
                                       {"Fluid deficit", millilitres(deficit(fluid.balance()))},
                                       {"Blood lost", millilitres(fluid.bloodLost())}};
    };
    TrainerTask task(sim, training,
                     {.steps = stepsOf(patient, scope.body(), chips, myoma.left),
                      .timeLimit = rules.timeLimit,
                      .guided = rules.guided,
                      .observed = observed,
                      .force = {.name = "Force on tissue",
                                .bodies = {scope.body(), loop.body()},
                                .warning = rules.warning,
                                .full = fullScale(rules)},
                      .done = "The myoma is off",
                      .dress = [&](VisualServer& server) { scope.dress(server); },
                      .results = results});
    chips.onChip = [&](double volume) { task.tracker().mark(EventKind::Removed, "myoma", volume); };
    const WallInjury wall(sim, bodies.uterus, loop, myoma.tooDeep,
                          [&](double) { task.tracker().mark(EventKind::Mistake, "too deep in the wall"); });
    watched = &wall;
    // From the start, because nothing can be told after the end.
    sim.everyStep([&, next = 0.0, left = -1.0, burnt = -1.0](double time) mutable {
        if (time < next) return;
        next = time + kTold;
        if (chips.left() != std::exchange(left, chips.left())) task.tracker().mark(EventKind::Residual, "myoma", left);
        if (wall.burnt() != std::exchange(burnt, wall.burnt())) task.tracker().mark(EventKind::Burn, "uterus", burnt);
    });
    const PerforationWatch watch(sim, {.wall = bodies.uterus,
                                       .tools = {{.body = scope.body(), .tip = {0, 0, 1_mm}}, {.body = loop.body()}},
                                       .force = rules.perforation,
                                       .tracker = &task.tracker(),
                                       .perforated = [&](Vec3 place, double) { fluid.pierced(place); }});
    perforations = &watch;

    const ResectionMotion with{
        patient,
        hands,
        loop,
        [&, nodes = meshOf(sim, bodies.polyp).nodes] {
            return rootOf(patient, nodes, sim.physics().latest()->softBody(bodies.polyp)->positions);
        },
        [&] { return rootedSurface(*sim.physics().latest()->softBody(bodies.polyp), patient.base); },
        [&](Vec3 place) { return wall.depthAt(place); },
        [&](const char* name) { return task.picture(name); },
        [&] { fluid.outflow(true); }};
    std::vector<HandMove> moves;
    if (training.motion == "expert") moves = expertResection(with);
    if (training.motion == "clumsy") moves = clumsyResection(with, static_cast<std::uint64_t>(training.seed));
    if (!moves.empty()) hands.play(moves);
    const int steps = static_cast<int>(1000 * durationOf(moves));
    return task.run(steps > 0 ? steps + 200 : 0, [&] {
        const EnergyBalance energy = sim.energy(loop.body(), WireLoop::kCuts);
        return text("chips ", chips.count(), ", left ", percent(chips.left()), ", cutting ",
                    std::round(10 * energy.active) / 10, " s, in the wall ", millimetres(wall.deepest()),
                    " deep, burnt ", squareMillimetres(wall.burnt()), ", ", wall.mistakes(), " mistakes, ",
                    watch.count(), " perforations, fluid deficit ", millilitres(deficit(fluid.balance())), ", blood ",
                    millilitres(fluid.bloodLost()));
    });
}

} // namespace hysteroscopy
