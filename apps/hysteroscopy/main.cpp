#include "apps/hysteroscopy/patient.h"

#include <filasofia/core/word.h>

#include <filesystem>
#include <map>

using namespace filasofia;
using namespace hysteroscopy;

namespace {

constexpr auto kHelp = R"(A hysteroscopy trainer: through the cervical canal, find the polyp, tear it off, bring it out.

  --case small|medium|lobed   which polyp (small)
  --seed N                    where it grows (1)
  --motion hand|expert        who moves: you, or a plan (hand)
  --trainee NAME              in the session
  --session FILE.jsonl        what happened, for 'filasofia report' (hysteroscopy_CASE_SEED_NUMBER.jsonl)
  --pictures FOLDER           pictures of the expert's motion
  --check-seeds N             tell whether the patients of seeds 1 to N can be treated, and end

Mouse: right drag turns the scope about the cervix, the wheel moves it. Keys: up and down move the scope, left and right
roll it, W and S move the forceps, G closes and opens them, T switches guidance, Space pauses, Escape ends.

All other options are every simulation's:
)";

struct Options {
    std::string caseName = "small", motion = "hand", trainee, session, pictures, seed = "1", checkSeeds;
    std::vector<std::string> rest; ///< for Simulation::run
    [[nodiscard]] bool has(const char* word) const { return std::ranges::find(rest, word) != rest.end(); }
};

Options parse(int argc, char** argv)
{
    Options options;
    const std::map<std::string, std::string*> values = {
        {"--case", &options.caseName},         {"--motion", &options.motion},     {"--trainee", &options.trainee},
        {"--session", &options.session},       {"--pictures", &options.pictures}, {"--seed", &options.seed},
        {"--check-seeds", &options.checkSeeds}};
    for (int i = 0; i < argc; ++i) {
        const auto found = values.find(argv[i]);
        if (found == values.end()) {
            options.rest.emplace_back(argv[i]);
            continue;
        }
        if (++i == argc) fail("hysteroscopy: ", found->first, " needs a value");
        *found->second = argv[i];
    }
    if (options.motion != "hand" && options.motion != "expert")
        fail("hysteroscopy: --motion must be hand or expert, got ", shownWord(options.motion));
    if (!options.pictures.empty() && !std::filesystem::is_directory(options.pictures))
        fail("hysteroscopy: --pictures must be a folder, got ", shownWord(options.pictures));
    return options;
}

int checkSeeds(const Options& options)
{
    const int count = wholeNumber("hysteroscopy: --check-seeds", options.checkSeeds, {closed(1, 1'000'000), "-"});
    int good = 0;
    for (int seed = 1; seed <= count; ++seed) {
        const std::string problem = makePatient(options.caseName, static_cast<std::uint64_t>(seed)).problem;
        good += problem.empty();
        if (!problem.empty()) std::printf("seed %d: %s\n", seed, problem.c_str());
    }
    std::printf("%d of %d patients can be treated\n", good, count);
    return good == count ? 0 : 1;
}

/// Asks who, which case, which seed. False: the window was closed.
bool ask(Options& options, int seed)
{
    StartScreenDef def{.title = "Hysteroscopy", .cases = kCases};
    def.choice.trainee = options.trainee;
    def.choice.caseIndex = static_cast<int>(std::ranges::find(kCases, options.caseName) - kCases.begin());
    def.choice.seed = static_cast<std::uint64_t>(seed);
    const auto chosen = askAtStart(def, {"Hysteroscopy", 720, 720});
    if (!chosen) return false;
    options.trainee = chosen->trainee;
    options.caseName = kCases[static_cast<std::size_t>(chosen->caseIndex)];
    options.seed = text(chosen->seed % 1'000'000'000);
    return true;
}

/// Nobody's session is written over: the next name that is free.
std::string sessionFile(const Options& options, int seed)
{
    if (!options.session.empty()) return options.session;
    for (int number = 1;; ++number) {
        const std::string file = text("hysteroscopy_", options.caseName, "_", seed, "_", number, ".jsonl");
        if (!std::filesystem::exists(file)) return file;
    }
}

/// Enters, looks around, grasps the polyp, tears it off and brings it out. `middle` tells where the polyp's head is
/// now.
std::vector<HandMove> expertMotion(const Patient& patient, const ScopeHands& hands, ArticulatedInstrument& forceps,
                                   const std::function<Vec3()>& middle,
                                   const std::function<std::function<void()>(const char*)>& picture)
{
    const auto axial = [](double y, double roll = 0.0, double reach = -6_mm) {
        return ScopeHand{{0, 1, 0}, y - kFulcrum.y, roll, reach};
    };
    // Tissue gives: before every move it looks again.
    const auto before = [&hands, middle](double away, double roll, double sheathed = 0.0) {
        return [=, &hands] {
            ScopeHand hand = hands.at(middle(), away, roll, 8_mm);
            hand.reach -= sheathed;
            return hand;
        };
    };
    const double roll = hands.rollAcross(patient.normal, patient.middle);
    std::vector<HandMove> moves = {{.seconds = 0.6, .to = axial(-6_mm), .end = picture("os")},
                                   {.seconds = 1.4, .to = axial(12_mm), .end = picture("canal")},
                                   {.seconds = 1.6, .to = axial(37_mm), .end = picture("cavity")},
                                   {.seconds = 0.5, .to = axial(37_mm, 50_deg)},
                                   {.seconds = 0.8, .to = axial(37_mm, -50_deg)},
                                   {.seconds = 0.8, .aim = before(12_mm, roll, 14_mm)},
                                   {.seconds = 0.4, .aim = before(11_mm, roll, 14_mm), .end = picture("polyp")}};
    // Soft tissue slips out of closing jaws: up to four times, from other sides and with the pivot elsewhere before it.
    const auto holds = [&forceps] { return static_cast<bool>(forceps.holding()); };
    for (const auto& [turned, close] : {std::pair{0_deg, 3_mm}, {60_deg, 2.5_mm}, {-60_deg, 3.5_mm}, {0_deg, 2_mm}}) {
        const double side = roll + turned;
        const auto open = [&forceps] { forceps.open(); };
        moves.insert(moves.end(), {{.seconds = 0.6, .aim = before(close + 6_mm, side), .skip = holds, .begin = open},
                                   {.seconds = 0.5, .aim = before(close + 5_mm, side), .skip = holds},
                                   {.seconds = 0.5, .aim = before(close + 2_mm, side), .skip = holds},
                                   {.seconds = 0.5, .aim = before(close, side), .skip = holds},
                                   {.seconds = 0.9,
                                    .aim = before(close - 0.5_mm, side),
                                    .skip = holds,
                                    .begin = [&] { forceps.close(); },
                                    .end = picture("grasped")}});
    }
    moves.insert(moves.end(), {{.seconds = 1.6, .to = axial(32_mm, 0.0, 8_mm), .end = picture("torn")},
                               {.seconds = 2.2, .to = axial(-25_mm, 0.0, 8_mm)}});
    return moves;
}

std::vector<TaskStep> stepsOf(const Patient& patient, const Bodies& bodies, BodyId scope,
                              const ArticulatedInstrument& forceps, std::size_t top)
{
    using frame::Frame;
    const auto tip = [=](const Frame& now) { return now.rigidBody(scope)->poses[0].position; };
    const auto head = [=](const Frame& now) { return now.softBody(bodies.polyp)->positions[top]; };
    const auto to = [](Vec3 place) { return [place](const Frame&) { return std::optional(place); }; };
    const auto done = [&](std::string name, std::string instruction, auto when, auto target) {
        return TaskStep{.name = std::move(name), .instruction = std::move(instruction), .done = when, .target = target};
    };
    const Vec3 root = patient.pose.position;
    return {done(
                "enter", "Enter through the external os", [=](const Frame& now) { return tip(now).y > 3_mm; }, to({})),
            done(
                "canal", "Follow the canal into the cavity", [=](const Frame& now) { return tip(now).y > 29_mm; },
                to({0, 32_mm, 0})),
            done(
                "find", "Find the polyp and come up to it",
                [=](const Frame& now) { return distance(tip(now), patient.middle) < 20_mm; }, to(patient.middle)),
            done(
                "grasp", "Open the forceps, take the polyp and close them",
                [=, &forceps](const Frame&) { return forceps.holding() == bodies.polyp; },
                [=](const Frame& now) { return std::optional(head(now)); }),
            done(
                "tear", "Pull until it comes off",
                [=](const Frame& now) { return distance(head(now), root) > 1.8 * patient.height; }, to({0, 32_mm, 0})),
            done(
                "bring out", "Bring it out", [=](const Frame& now) { return head(now).y < -1_mm; }, to({}))};
}

int train(const Options& options, int seed)
{
    const Patient patient = makePatient(options.caseName, static_cast<std::uint64_t>(seed));
    const bool expert = options.motion == "expert";
    // In the fluid all floats. A step may take longer than it lasts: tissue that is solved badly tears by that alone.
    Simulation sim({.physics = {.gravity = {}, .contact = ExactContact{.tolerance = 2e-2}, .deadline = 5e-3},
                    .window = {"Hysteroscopy", 720, 720},
                    .look = {.mouse = false, .keys = false}});
    const Bodies bodies = addPatient(sim, patient);
    Endoscope scope(
        sim, {.name = "hysteroscope", .pose = {{0, -0.1, 0}, {}}, .groups = {ScopeWall, ScopePolyp}, .intensity = 2.0});
    MetricTracker* marks = nullptr;
    const auto onGrasp = [&](BodyId body, bool on) {
        marks->mark(on ? EventKind::Grasp : EventKind::Release, body == bodies.polyp ? "polyp" : "uterus");
    };
    // Of the shaft only what can leave the channel touches tissue.
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
    ScopeHands hands(sim, scope, forceps,
                     {.fulcrum = kFulcrum,
                      .up = {0, 0, 1},
                      .start = {{0, 1, 0}, -39_mm, 0, -6_mm},
                      .leastDepth = -60_mm,
                      .mostDepth = 36_mm,
                      .mostReach = 12_mm});

    const std::string file = sessionFile(options, seed);
    MetricTrackerDef observed{.bodies = {{.body = forceps.body(), .tip = {0, 0, -4.5_mm}},
                                         {.body = scope.body(), .role = Role::Scope, .element = Endoscope::kCamera}},
                              .file = file};
    observed.session = {.trainee = options.trainee,
                        .task = "hysteroscopy " + options.caseName,
                        .software = "Filasofia",
                        .seed = static_cast<std::uint64_t>(seed),
                        .forceLimit = 3.0,
                        .fieldOfView = EndoscopeDef{}.fieldOfView,
                        .targets = {"polyp"},
                        .watched = {EventKind::Grasp, EventKind::Release}};
    const auto nodes = physics::worldMesh(std::get<SoftBodyDef>(*sim.physics().def(bodies.polyp))).nodes;
    const auto height = [&](Vec3 node) { return dot(node - patient.pose.position, patient.normal); };
    const auto top = static_cast<std::size_t>(std::ranges::max_element(nodes, {}, height) - nodes.begin());
    std::vector<TaskStep> steps = stepsOf(patient, bodies, scope.body(), forceps, top);
    for (const TaskStep& step : steps) observed.session.steps.push_back(step.name);
    MetricTracker tracker(sim, observed);
    marks = &tracker;

    EndScreen end(sim);
    end.onClose([&] { sim.finish("closed"); });
    const ForceBar bar(sim,
                       {.name = "Force on tissue", .bodies = {scope.body(), forceps.body()}, .warning = 3, .full = 5});
    const auto over = [&](bool done) {
        if (expert) return sim.finish(done ? "the polyp is out" : "time is up");
        end.show(done ? "The polyp is out" : "Time is up",
                 {{"Trainee", options.trainee},
                  {"Highest force", text(std::lround(1000 * bar.highest()), " mN")},
                  {"Warnings", text(bar.warnings())}},
                 file);
    };
    const Task task(sim, {.name = "hysteroscopy", .steps = steps, .timeLimit = 600, .tracker = &tracker, .over = over});
    Guidance guidance(sim, task);
    std::atomic<bool> guided = !expert;
    guidance.setOn(guided);
    sim.on<KeyEvent>([&](const KeyEvent& key) {
        if (!key.pressed || key.repeat) return;
        if (key.key == KeyCode::T) guidance.setOn(guided = !guided);
        if (key.key == KeyCode::Space) sim.pause(!sim.paused());
        if (key.key == KeyCode::Escape) sim.finish("ended");
    });
    sim.on<TearEvent>([&](const TearEvent& tear) {
        for (const BodyId body : {bodies.uterus, bodies.polyp})
            sim.paint(body, {.place = tear.rupture.place, .radius = 2.5_mm, .state = {.blood = 0.6, .wetness = 1.0}});
    });
    sim.dress([&](VisualServer& server) {
        scope.dress(server);
        guidance.dress(server);
    });

    std::vector<std::string> words = options.rest; // and what a recording tells of the session
    words.insert(words.end(), {text("--seed=", seed), "--session=hysteroscopy " + options.caseName});
    if (!options.trainee.empty()) words.push_back("--trainee=" + options.trainee);
    const bool whole = expert && !options.has("--steps");
    if (expert) {
        const auto picture = [&](const char* name) -> std::function<void()> {
            if (options.pictures.empty()) return {};
            return [&sim, name = text(options.pictures, "/", name, ".png")] { sim.screenshot(name); };
        };
        const auto from = [&](Vec3 node) { return distance(node, patient.middle); };
        const auto inside = static_cast<std::size_t>(std::ranges::min_element(nodes, {}, from) - nodes.begin());
        const auto middle = [&, inside] { return sim.physics().latest()->softBody(bodies.polyp)->positions[inside]; };
        const auto moves = expertMotion(patient, hands, forceps, middle, picture);
        if (whole) words.insert(words.end(), {"--steps", text(std::lround(1000 * durationOf(moves)) + 200)});
        hands.play(moves);
    }
    std::vector<const char*> arguments;
    for (const std::string& word : words) arguments.push_back(word.c_str());
    if (const int problem = sim.run(static_cast<int>(arguments.size()), arguments.data())) return problem;
    tracker.close();
    const TaskProgress progress = task.progress();
    const bool done = progress.state == TaskProgress::State::Done;
    std::printf("%s: %d of %zu steps in %.1f s; highest force %.2f N, %d warnings; session: %s\n",
                done ? "done" : "not done", progress.step, steps.size(), progress.time, bar.highest(), bar.warnings(),
                file.c_str());
    return whole && !done ? 1 : 0;
}

} // namespace

int main(int argc, char** argv)
try {
    Options options = parse(argc, argv);
    if (!options.checkSeeds.empty()) return checkSeeds(options);
    if (options.has("--help") || options.has("-h")) {
        std::puts(kHelp);
        return Simulation().run(argc, argv);
    }
    const auto seed = [&] { return wholeNumber("hysteroscopy: --seed", options.seed, {closed(0, 999'999'999), "-"}); };
    makePatient(options.caseName, static_cast<std::uint64_t>(seed())); // a wrong case is told before any window opens
    if (options.motion == "expert" || options.has("--headless")) return train(options, seed());
    while (ask(options, seed()))
        if (const int problem = train(options, seed()); problem != 0 || !options.session.empty()) return problem;
    return 0;
} catch (const Error& error) {
    return report(error);
}
