#include "apps/hysteroscopy/fluid.h"
#include "apps/hysteroscopy/motion.h"
#include "apps/hysteroscopy/resection.h"
#include "apps/hysteroscopy/theatre.h"

using namespace filasofia;
using namespace hysteroscopy;

namespace {

std::vector<TaskStep> stepsOf(const Patient& patient, const Bodies& bodies, BodyId scope,
                              const ArticulatedInstrument& forceps, std::size_t top)
{
    using frame::Frame;
    const auto head = [=](const Frame& now) { return now.softBody(bodies.polyp)->positions[top]; };
    const auto holdsPolyp = [=, &forceps] { return forceps.holding() == bodies.polyp; };
    const auto to = [](Vec3 place) { return [place](const Frame&) { return std::optional(place); }; };
    const auto done = [&](const char* name, const char* instruction, auto when, auto target) {
        return TaskStep{.name = name, .instruction = instruction, .done = when, .target = target};
    };
    const Vec3 root = patient.pose.position;
    std::vector<TaskStep> steps = wayIn(patient, scope, "Find the polyp and come up to it");
    steps.insert(
        steps.end(),
        {done(
             "grasp", "Open the forceps, take the polyp and close them", [=](const Frame&) { return holdsPolyp(); },
             [=](const Frame& now) { return std::optional(head(now)); }),
         done(
             "tear", "Pull until it comes off",
             [=](const Frame& now) { return distance(head(now), root) > 1.8 * patient.height; }, to({0, 32_mm, 0})),
         done(
             "bring out", "Bring it out", [=](const Frame& now) { return holdsPolyp() && head(now).y < -1_mm; },
             to({}))});
    return steps;
}

int train(const Training& training)
{
    const std::string& caseName = kCases[static_cast<std::size_t>(training.caseIndex)];
    const Patient patient = makePatient(caseName, static_cast<std::uint64_t>(training.seed));
    if (patient.kind == Patient::Kind::Myoma) return resection(training, patient);
    const Rules rules = training.rules(kRules[training.difficulty]);
    Simulation sim(theatre());
    const Bodies bodies = addPatient(sim, patient, training);
    // An artery leads through the root of a polyp: 6 mm^2 of it lose 0.4 ml a minute.
    Fluid fluid(sim, bodies, rules.pressure, 1e-3);
    Endoscope scope(sim, scopeOf({ScopeWall, ScopePolyp}));
    MetricTracker* marks = nullptr;
    const auto onGrasp = [&](BodyId body, bool on) {
        marks->mark(on ? EventKind::Grasp : EventKind::Release, body == bodies.polyp ? "polyp" : "uterus");
    };
    // Only the part of the shaft that can leave the channel collides with tissue.
    TriangleMesh shaft = *shapes::cylinder(0.83_mm, 10_mm, 2);
    for (Vec3& vertex : shaft.vertices) vertex = {vertex.x, -vertex.z, vertex.y + 5_mm};
    ArticulatedInstrument forceps(sim, {.name = "forceps",
                                        .pose = scope.channel(),
                                        .shaftCollision = std::make_shared<const TriangleMesh>(shaft),
                                        .groups = {ForcepsWall, ForcepsPolyp},
                                        .closingTorque = 0.15e-3,
                                        .gripStiffness = 300.0,
                                        .material = MetalMaterial{.roughness = 0.5},
                                        .onGrasp = onGrasp});
    ScopeHands hands(sim, scope, forceps, handsOf(training, 12_mm));
    if (training.devices > 0) sim.add(HapticInterfaceDef{.name = "hand", .body = hands.handle()});

    MetricTrackerDef observed =
        observedIn(training, {.body = forceps.body(), .tip = {0, 0, -4.5_mm}}, scope.body(), "polyp");
    observed.session.watched.insert(observed.session.watched.begin(), {EventKind::Grasp, EventKind::Release});
    const auto nodes = physics::worldMesh(std::get<SoftBodyDef>(*sim.physics().def(bodies.polyp))).nodes;
    const auto height = [&](Vec3 node) { return dot(node - patient.pose.position, patient.normal); };
    const auto top = static_cast<std::size_t>(std::ranges::max_element(nodes, {}, height) - nodes.begin());
    const std::vector<TaskStep> taskSteps = stepsOf(patient, bodies, scope.body(), forceps, top);
    for (const TaskStep& step : taskSteps) observed.session.steps.push_back(step.name);
    MetricTracker tracker(sim, observed);
    marks = &tracker;

    const ForceBar bar(sim, {.name = "Force on tissue",
                             .bodies = {scope.body(), forceps.body()},
                             .warning = rules.warning,
                             .full = fullScale(rules)});
    const PerforationWatch perforations(
        sim, {.wall = bodies.uterus,
              .tools = {{.body = scope.body(), .tip = {0, 0, 1_mm}}, {.body = forceps.body()}},
              .force = rules.perforation,
              .tracker = &tracker,
              .perforated = [&](Vec3 place, double) { fluid.pierced(place); }});
    TrainingSession session(sim, training);
    session.records(tracker);
    const Task* running = nullptr;
    const auto over = [&](bool done) {
        const auto results = [&] {
            return std::vector<ResultLine>{{"Highest total force", text(std::lround(1000 * bar.highest()), " mN")},
                                           {"Warnings", text(bar.warnings())},
                                           {"Perforations", text(perforations.count())},
                                           {"Fluid deficit", millilitres(deficit(fluid.balance()))},
                                           {"Blood lost", millilitres(fluid.bloodLost())}};
        };
        session.over(done ? "The polyp is out" : "Time is up", results,
                     {.done = done, .seconds = running->progress().time});
    };
    const Task task(
        sim,
        {.name = "hysteroscopy", .steps = taskSteps, .timeLimit = rules.timeLimit, .tracker = &tracker, .over = over});
    running = &task;
    Guidance guidance(sim, task);
    session.guide(guidance, rules.guided && training.motion.empty());
    sim.dress([&](VisualServer& server) {
        scope.dress(server);
        guidance.dress(server);
        session.dress(server);
    });

    const auto from = [&](Vec3 node) { return distance(node, patient.middle); };
    const auto inside = static_cast<std::size_t>(std::ranges::min_element(nodes, {}, from) - nodes.begin());
    const Motion with{patient,
                      hands,
                      forceps,
                      [&, inside] { return sim.physics().latest()->softBody(bodies.polyp)->positions[inside]; },
                      [&](const char* name) { return session.picture(name); },
                      [&] { fluid.outflow(true); }};
    std::vector<HandMove> moves;
    if (training.motion == "expert") moves = expertMotion(with);
    if (training.motion == "clumsy") moves = clumsyMotion(with, static_cast<std::uint64_t>(training.seed));
    if (!moves.empty()) hands.play(moves);
    const int steps = static_cast<int>(1000 * durationOf(moves));
    if (const int problem = session.run(steps > 0 ? steps + 200 : 0)) return problem;
    task.leave();
    tracker.close();
    const TaskProgress progress = task.progress();
    const bool done = progress.state == TaskProgress::State::Done;
    std::printf(
        "%s: %d of %zu steps in %.1f s; highest total force %.2f N, %d warnings, %d perforations, fluid deficit %.1f "
        "ml, blood %.3f ml; session%s: %s\n",
        done ? "done" : "not done", progress.step, taskSteps.size(), progress.time, bar.highest(), bar.warnings(),
        perforations.count(), deficit(fluid.balance()) * 1e6, fluid.bloodLost() * 1e6,
        tracker.failed() ? " (incomplete)" : "", training.file.c_str());
    if (tracker.failed()) return 1;
    return training.motion == "expert" && !session.cutShort() && !done ? 1 : 0;
}

std::vector<TrainerSetting> settings()
{
    std::vector<TrainerSetting> all = settingsOf<Rules>(kRules);
    const auto add = [&](const std::vector<TrainerSetting>& more) { all.insert(all.end(), more.begin(), more.end()); };
    add(settingsOf<PolypRules>(std::array<PolypRules, 3>(), {"small", "medium", "lobed"}));
    add(settingsOf<MyomaRules>(std::array<MyomaRules, 3>(), {"resection"}));
    return all;
}

} // namespace

int main(int argc, char** argv)
{
    TrainerDef def{
        .name = "hysteroscopy",
        .about = "A hysteroscopy trainer: pass the cervical canal, tear a polyp off, or shave a myoma off with a loop.",
        .hands =
            "Drag with the right button to turn the scope about the cervix. The wheel and the keys up and down\n"
            "move it in and out; left and right roll it.\n"
            "W and S move the forceps, G closes and opens them. A haptic device (--device) holds the scope's outer\n"
            "end: its first button acts as G; while its second is pressed, moving in and out moves the forceps.\n"
            "The case resection has a loop in place of the forceps: it cuts while G or the first button is pressed, "
            "and\n"
            "coagulates while B is.\n"
            "I opens and closes the inflow of the fluid, O its outflow; U and J change its pressure.\n",
        .cases = kCases,
        .difficulties = kDifficulties,
        .motions = {"expert", "clumsy"},
        .pictures = {"thumbnails/small.png", "thumbnails/medium.png", "thumbnails/lobed.png",
                     "thumbnails/resection.png"},
        .window = {"Hysteroscopy", 720, 720},
        .problem = [](int caseIndex, int seed) {
            return makePatient(kCases[static_cast<std::size_t>(caseIndex)], static_cast<std::uint64_t>(seed)).problem;
        }};
    def.settings = settings();
    def.readCase = loadCase;
    return runTrainer(argc, argv, def, train);
}
