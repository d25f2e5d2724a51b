#include "apps/hysteroscopy/expert.h"

#include <filasofia/core/word.h>
#include <filasofia/prefab/overlays.h>
#include <filasofia/prefab/screens.h>

#include <cstdio>
#include <filesystem>
#include <mutex>

using namespace filasofia;
using namespace hysteroscopy;

namespace {

constexpr auto kHelp = R"(A hysteroscopy trainer: through the cervical canal, find the polyp, tear it off, bring it out.

  --case small|medium|lobed   which polyp (small)
  --seed N                    where it grows (1)
  --motion hand|expert        who moves: you, or a plan (hand)
  --trainee NAME              in the session
  --session FILE.jsonl        what happened, for 'filasofia report' (hysteroscopy_CASE_SEED.jsonl)
  --pictures FOLDER           pictures of the expert's motion
  --no-guidance               no texts and arrows
  --check-seeds N             tell whether the patients of seeds 1 to N can be treated, and end

Mouse: right drag turns the scope about the cervix, the wheel moves it. Keys: arrows up and down move the scope, left and
right roll it, W and S the forceps, G closes and opens them, T guidance. All other options as for every simulation:
)";

struct Options {
    std::string caseName = "small", motion = "hand", trainee = {}, session = {}, pictures = {};
    std::uint64_t seed = 1;
    int checkSeeds = 0;
    bool guidance = true, help = false;
    std::vector<std::string> rest = {}; ///< for Simulation::run
};

Options parse(int argc, char** argv)
{
    Options options;
    options.rest.push_back(argv[0]);
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const auto value = [&]() -> std::string {
            if (i + 1 == argc) fail("hysteroscopy: ", word, " needs a value");
            return argv[++i];
        };
        const auto count = [&](int least) {
            return wholeNumber("hysteroscopy: " + word, value(), {closed(least, 1'000'000'000), "-"});
        };
        if (word == "--case")
            options.caseName = value();
        else if (word == "--seed")
            options.seed = static_cast<std::uint64_t>(count(0));
        else if (word == "--motion")
            options.motion = value();
        else if (word == "--trainee")
            options.trainee = value();
        else if (word == "--session")
            options.session = value();
        else if (word == "--pictures")
            options.pictures = value();
        else if (word == "--no-guidance")
            options.guidance = false;
        else if (word == "--check-seeds")
            options.checkSeeds = count(1);
        else {
            options.help |= word == "--help" || word == "-h";
            options.rest.push_back(word);
        }
    }
    if (options.motion != "hand" && options.motion != "expert")
        fail("hysteroscopy: --motion must be hand or expert, got ", shownWord(options.motion));
    if (!options.pictures.empty() && !std::filesystem::is_directory(options.pictures))
        fail("hysteroscopy: --pictures must be a folder, got ", shownWord(options.pictures));
    if (options.session.empty()) options.session = text("hysteroscopy_", options.caseName, "_", options.seed, ".jsonl");
    return options;
}

int checkSeeds(const Options& options)
{
    int bad = 0;
    for (int seed = 1; seed <= options.checkSeeds; ++seed) {
        const Patient patient = makePatient(options.caseName, static_cast<std::uint64_t>(seed));
        if (patient.problem.empty()) continue;
        std::printf("seed %d: %s\n", seed, patient.problem.c_str());
        ++bad;
    }
    std::printf("%d of %d patients can be treated\n", options.checkSeeds - bad, options.checkSeeds);
    return bad == 0 ? 0 : 1;
}

/// A person's hands: events tell where they want to be, and the stepping thread goes there, smoothly.
class HandControl {
public:
    explicit HandControl(Simulation& sim)
    {
        sim.on<MouseMoveEvent>([this](const MouseMoveEvent& move) {
            if (!move.buttons.right) return;
            const std::lock_guard lock(mutex_);
            turned_.x = std::clamp(turned_.x + 0.002 * move.dx, -0.6, 0.6);
            turned_.z = std::clamp(turned_.z - 0.002 * move.dy, -0.6, 0.6);
        });
        sim.on<MouseWheelEvent>([this](const MouseWheelEvent& wheel) { shift(1.5_mm * wheel.dy, 0, 0); });
        sim.on<KeyEvent>([this](const KeyEvent& key) {
            if (!key.pressed) return;
            if (key.key == KeyCode::Up) shift(1_mm, 0, 0);
            if (key.key == KeyCode::Down) shift(-1_mm, 0, 0);
            if (key.key == KeyCode::Left) shift(0, 5_deg, 0);
            if (key.key == KeyCode::Right) shift(0, -5_deg, 0);
            if (key.key == KeyCode::W) shift(0, 0, 0.7_mm);
            if (key.key == KeyCode::S) shift(0, 0, -0.7_mm);
        });
    }
    /// A step of `dt` on the way to where they want to be.
    Hand follow(double dt)
    {
        const std::lock_guard lock(mutex_);
        const double share = 1.0 - std::exp(-dt / 0.06);
        now_.aim = normalized(now_.aim + share * (normalized(Vec3{turned_.x, 1, turned_.z}) - now_.aim));
        now_.depth += share * (wanted_.depth - now_.depth);
        now_.roll += share * (wanted_.roll - now_.roll);
        now_.reach += share * (wanted_.reach - now_.reach);
        return now_;
    }

private:
    void shift(double depth, double roll, double reach)
    {
        const std::lock_guard lock(mutex_);
        wanted_.depth = std::clamp(wanted_.depth + depth, -60_mm, 36_mm);
        wanted_.roll += roll;
        wanted_.reach = std::clamp(wanted_.reach + reach, -10_mm, 30_mm);
    }
    std::mutex mutex_;
    Hand wanted_, now_;
    Vec3 turned_ = {};
};

/// The node of the polyp that is farthest from its root.
int topOf(const SoftBodyDef& polyp)
{
    const auto& nodes = std::get<std::shared_ptr<const TetMesh>>(polyp.mesh)->nodes;
    return static_cast<int>(std::ranges::max_element(nodes, {}, &Vec3::y) - nodes.begin());
}

std::vector<prefab::TaskStep> stepsOf(const Patient& patient, const Bodies& bodies, BodyId scope,
                                      const prefab::ArticulatedInstrument& forceps, int top)
{
    const auto tip = [=](const frame::Frame& frame) { return frame.rigidBody(scope)->poses[0].position; };
    const auto head = [=](const frame::Frame& frame) {
        return frame.softBody(bodies.polyp)->positions[static_cast<std::size_t>(top)];
    };
    const auto to = [](Vec3 place) { return [place](const frame::Frame&) { return std::optional(place); }; };
    const Vec3 site = patient.site.at;
    const double torn = 1.8 * patient.polyp.height;
    return {{.name = "enter",
             .instruction = "Enter through the external os",
             .done = [=](const frame::Frame& frame) { return tip(frame).y > 3_mm; },
             .target = to({0, 2_mm, 0})},
            {.name = "canal",
             .instruction = "Follow the cervical canal into the cavity",
             .done = [=](const frame::Frame& frame) { return tip(frame).y > 29_mm; },
             .target = to({0, 32_mm, 0})},
            {.name = "find",
             .instruction = "Find the polyp and come up to it",
             .done = [=](const frame::Frame& frame) { return distance(tip(frame), patient.middle) < 20_mm; },
             .target = to(patient.middle)},
            {.name = "grasp",
             .instruction = "Open the forceps, take the polyp and close them",
             .done = [&forceps, bodies](const frame::Frame&) { return forceps.holding() == bodies.polyp; },
             .target = [=](const frame::Frame& frame) { return std::optional(head(frame)); }},
            {.name = "tear",
             .instruction = "Pull until it comes off",
             .done = [=](const frame::Frame& frame) { return distance(head(frame), site) > torn; }},
            {.name = "bring out",
             .instruction = "Bring it out",
             .done = [=](const frame::Frame& frame) { return head(frame).y < -1_mm; },
             .target = to({})}};
}

int train(const Options& options)
{
    const Patient patient = makePatient(options.caseName, options.seed);
    const bool expert = options.motion == "expert";
    Simulation sim({.physics = {.gravity = {}}, // what is in the fluid floats
                    .window = {"Hysteroscopy", 720, 720},
                    .look = {.mouse = false}});
    const Bodies bodies = addPatient(sim, patient);
    const int top = topOf(std::get<SoftBodyDef>(*sim.physics().def(bodies.polyp)));
    prefab::Endoscope scope(sim,
                            {.name = "hysteroscope", .pose = lookAt({0, -15_mm, 0}, {}, {0, 0, 1}), .groups = {0, 1}});
    MetricTracker* marks = nullptr;
    prefab::ArticulatedInstrument forceps(sim, {.name = "forceps",
                                                .pose = scope.channel(),
                                                .groups = {0, 1},
                                                .closingTorque = 0.15e-3,
                                                .onGrasp = [&](BodyId body, bool on) {
                                                    if (marks)
                                                        marks->mark(on ? EventKind::Grasp : EventKind::Release,
                                                                    body == bodies.polyp ? "polyp" : "uterus");
                                                }});
    apply({}, scope, forceps);

    MetricTracker tracker(
        sim, {.bodies = {{.body = forceps.body(), .tip = {0, 0, -4.5_mm}},
                         {.body = scope.body(), .role = Role::Scope, .element = prefab::Endoscope::kCamera}},
              .file = options.session,
              .session = {.trainee = options.trainee,
                          .task = "hysteroscopy " + options.caseName,
                          .software = "Filasofia",
                          .seed = options.seed,
                          .forceLimit = 2.0,
                          .fieldOfView = prefab::EndoscopeDef{}.fieldOfView,
                          .targets = {"polyp"},
                          .steps = {"enter", "canal", "find", "grasp", "tear", "bring out"},
                          .watched = {EventKind::Grasp, EventKind::Release}}});
    marks = &tracker;
    prefab::EndScreen end(sim);
    const prefab::ForceBar bar(
        sim, {.name = "Force on tissue", .bodies = {scope.body(), forceps.body()}, .warning = 1.5, .full = 3.0});
    std::optional<prefab::Task> task;
    task.emplace(sim, prefab::TaskDef{.name = "hysteroscopy",
                                      .steps = stepsOf(patient, bodies, scope.body(), forceps, top),
                                      .timeLimit = 600,
                                      .tracker = &tracker,
                                      .over = [&](bool done) {
                                          char seconds[32], force[32];
                                          std::snprintf(seconds, sizeof seconds, "%.1f s", task->progress().time);
                                          std::snprintf(force, sizeof force, "%.2f N", bar.highest());
                                          end.show(done ? "The polyp is out" : "Time is up",
                                                   {{"Trainee", options.trainee},
                                                    {"Time", seconds},
                                                    {"Highest force", force},
                                                    {"Warnings", text(bar.warnings())}},
                                                   options.session);
                                          if (expert) sim.finish(done ? "the polyp is out" : "time is up");
                                      }});
    prefab::Guidance guidance(sim, *task);
    std::atomic<bool> guided = options.guidance && !expert;
    guidance.setOn(guided);

    sim.on<TearEvent>([&](const TearEvent& tear) {
        for (const BodyId body : {bodies.uterus, bodies.polyp})
            sim.paint(body, {.place = tear.rupture.place, .radius = 3.5_mm, .state = {.blood = 0.7, .wetness = 1.0}});
    });
    std::atomic<bool> closed = true;
    sim.on<KeyEvent>([&](const KeyEvent& key) {
        if (!key.pressed || key.repeat) return;
        if (key.key == KeyCode::G) (closed = !closed) ? forceps.close() : forceps.open();
        if (key.key == KeyCode::T) guidance.setOn(guided = !guided);
    });

    HandControl hands(sim);
    const std::vector<Move> plan = expertMotion(patient);
    std::size_t move = 0;
    double last = 0.0;
    sim.everyStep([&](double time) {
        const double dt = time - std::exchange(last, time);
        if (!expert) return apply(hands.follow(dt), scope, forceps);
        const Moment moment = at(plan, time);
        for (; move <= moment.move && move <= plan.size(); ++move) { // the moves that begin now
            if (move > 0 && !plan[move - 1].picture.empty() && !options.pictures.empty())
                sim.screenshot(text(options.pictures, "/", plan[move - 1].picture, ".png"));
            if (move == plan.size()) continue;
            if (plan[move].jaws == Jaws::Open) forceps.open();
            if (plan[move].jaws == Jaws::Close) forceps.close();
        }
        apply(moment.hand, scope, forceps);
    });
    sim.dress([&](VisualServer& server) {
        scope.dress(server);
        server.setEnvironment({.intensity = 25, .lampStrength = 2});
        guidance.dress(server);
    });
    std::vector<std::string> words = options.rest;
    const bool endless = std::ranges::find(words, "--steps") == words.end();
    if (expert && endless) words.insert(words.end(), {"--steps", text(std::lround(1000 * durationOf(plan)) + 200)});
    std::vector<const char*> arguments;
    for (const std::string& word : words) arguments.push_back(word.c_str());
    const int problem = sim.run(static_cast<int>(arguments.size()), arguments.data());
    tracker.close();
    if (problem != 0 || options.help) return problem;
    const prefab::TaskProgress progress = task->progress();
    const bool done = progress.state == prefab::TaskProgress::State::Done;
    std::printf("%s: %d of %zu steps, %.1f s; highest force %.2f N, %d warnings; session: %s\n",
                done ? "done" : "not done", progress.step, task->def().steps.size(), progress.time, bar.highest(),
                bar.warnings(), options.session.c_str());
    return expert && endless && !done ? 1 : 0;
}

} // namespace

int main(int argc, char** argv)
try {
    const Options options = parse(argc, argv);
    if (options.checkSeeds > 0) return checkSeeds(options);
    if (options.help) std::puts(kHelp);
    return train(options);
} catch (const Error& error) {
    return report(error);
}
