#include "apps/filasofia/bunny_scene.h"
#include "apps/filasofia/command_line.h"
#include "apps/filasofia/commands.h"
#include "apps/filasofia/contact_scenes.h"
#include "apps/filasofia/haptic_scene.h"
#include "apps/filasofia/import_words.h"
#include "apps/filasofia/rupture_scenes.h"
#include "apps/filasofia/scene_reload.h"
#include "filasofia/core/log.h"
#include "filasofia/runtime/assets.h"
#include "filasofia/runtime/engines.h"
#include "filasofia/runtime/keys.h"
#include "filasofia/scene/import.h"

#include <cmath>
#include <filesystem>
#include <iostream>

namespace filasofia::app {
namespace {

struct RunCommandOptions {
    std::string scene;
    BunnyDef bunny;
    double rate = 1000.0;
    int threads = 0;
    std::string engine = runtime::engineNames().front();
    bool failOnWarnings = false;
    ImportWords import;
    std::string measures, sensors;
    RunDef run;
};

/// A scene that can be run by its name.
struct Scene {
    const char* name;
    Box around; ///< the camera looks at this box
    void (*make)(Simulation&, const BunnyDef&);
};

const Scene kScenes[] = {
    {"bunny", bunnyRoom(), [](Simulation& sim, const BunnyDef& def) { addBunny(sim, def); }},
    {"poke", kPokeRoom, [](Simulation& sim, const BunnyDef& def) { addPoke(sim, def.subdivision); }},
    {"grasp", kGraspRoom, [](Simulation& sim, const BunnyDef& def) { addGrasp(sim, def.subdivision); }},
    {"friction", kFrictionRoom, [](Simulation& sim, const BunnyDef&) { addFriction(sim); }},
    {"cut", kCutRoom, [](Simulation& sim, const BunnyDef& def) { addCut(sim, def.subdivision); }},
    {"tear", kTearRoom, [](Simulation& sim, const BunnyDef& def) { addTear(sim, def.subdivision); }},
    {"haptics", kHapticsRoom, [](Simulation& sim, const BunnyDef& def) { addHaptics(sim, def.subdivision); }},
};

/// Scene files that come with Filasofia and can be run by their names (assets/scenes).
constexpr std::array<std::string_view, 1> kSceneFiles = {"suture"};

const Scene& sceneOf(const RunCommandOptions& options)
{
    std::string names;
    for (const Scene& scene : kScenes) {
        if (options.scene == scene.name) return scene;
        names += text(names.empty() ? "" : ", ", scene.name);
    }
    if (options.scene.find_first_of("./") != std::string::npos)
        fail("run: a scene file has a name that ends in .json, .urdf, .xml, .mjcf or .scn, got '",
             shortened(options.scene), "'");
    for (const std::string_view file : kSceneFiles) names += text(", ", file);
    fail("run: unknown scene '", shortened(options.scene), "'; known are ", names,
         ", and scene files (.json, .urdf, .xml, .mjcf, .scn)");
}

std::vector<std::string> bunnySizes()
{
    std::vector<std::string> sizes;
    for (const int size : kBunnySizes) sizes.push_back(text(size));
    return sizes;
}

int print(const RunReport& report, const RunCommandOptions& options)
{
    std::cout << runtime::summary(report);
    return report.complete() && !(options.failOnWarnings && !runtime::warnings(report).empty()) ? 0 : kFailed;
}

/// Refuses an option that the file says itself.
template <class T> void checkDefault(std::string_view name, const T& value, const T& standard)
{
    if (value != standard) fail("run: ", name, " does not apply to a scene file, which says it itself");
}

/// Somebody looks at a window, and a new start overwrites nothing.
bool isWatched(const RunDef& run)
{
    return !run.headless && run.backend == visual::Backend::Window && run.log.empty() && run.record.empty() &&
           run.recordMotion.empty() && run.picture.empty() && run.video.empty();
}

/// One window for all runs of a scene.
class LentWindow final : public window::Window {
public:
    explicit LentWindow(std::shared_ptr<window::Window> window) : window_(std::move(window)) {}
    [[nodiscard]] void* nativeWindow() const override { return window_->nativeWindow(); }
    [[nodiscard]] window::WindowSize size() const override { return window_->size(); }
    [[nodiscard]] double scale() const override { return window_->scale(); }
    void poll(const event::EventSink& sink) override { window_->poll(sink); }
    [[nodiscard]] bool shouldClose() const override { return window_->shouldClose(); }
    void setTitle(const std::string& title) override { window_->setTitle(title); }
    void setTextInput(bool on) override { window_->setTextInput(on); }

private:
    std::shared_ptr<window::Window> window_;
};

/// Runs a scene until its person ends it; begins it anew when its files have changed, or at Ctrl+R.
RunReport runReloading(LoadedScene& scene, const RunCommandOptions& options, const std::function<LoadedScene()>& load)
{
    std::shared_ptr<window::Window> window;
    const std::string again = text(options.scene, " is read again");
    for (;;) {
        Simulation& sim = *scene.simulation;
        sim.useWindow([&](const window::WindowDef& def) {
            if (!window) window = window::openWindow(def);
            window->setTitle(def.title);
            return std::make_unique<LentWindow>(window);
        });
        SceneReload reload(scene, load, [&] { sim.finish(again); });
        const event::ObserverId observer = sim.on<KeyEvent>([&](const KeyEvent& key) {
            if (key.pressed && !key.repeat && key.key == event::KeyCode::R && key.modifiers.control) reload.ask();
        });
        RunReport report = sim.run(options.run);
        sim.events().detach(observer); // before `reload` ends
        if (report.finished != again) return report;
        logInfo(again);
        scene = reload.take();
    }
}

/// Says how far a task is that the run has left before its end; empty if it is over.
std::string unfinishedLine(const prefab::Task& task)
{
    if (task.progress().state != prefab::TaskProgress::State::Running) return {};
    return text("task '", prefab::shown(task.def().name), "' is not finished: ", task.status(), "\n");
}

/// Says how many throws of a knot are tied.
std::string knotLine(const scene::SceneKnotProgress& knot)
{
    return text("knot '", prefab::shown(knot.name), "': ", knot.tied, " of ", knot.throws,
                knot.throws == 1 ? " throw" : " throws", " tied, drawn with up to ",
                std::round(100.0 * knot.largestForce) / 100.0, " N\n");
}

/// Says what the table of the sensors has.
std::string sensorsLine(const prefab::Sensors& sensors, const std::string& file)
{
    return text("wrote ", file, ": ", sensors.lines(), sensors.lines() == 1 ? " line" : " lines", " of ",
                sensors.read().size(), sensors.read().size() == 1 ? " sensor" : " sensors",
                sensors.failed() ? ", and not to the end" : "", "\n");
}

/// Says which commands of the scene a run of a given number of steps has ended before; empty if none.
std::string lateCommandsLine(const std::vector<scene::TimedCommand>& commands, const RunReport& report)
{
    std::size_t late = 0;
    const scene::TimedCommand* first = nullptr;
    for (const scene::TimedCommand& each : commands) {
        if (!(each.time > report.time)) continue;
        ++late;
        if (!first || each.time < first->time) first = &each;
    }
    if (late == 0) return {};
    return text(late == 1 ? "a command is" : text(late, " commands are"),
                " later than the end of the run: ", late == 1 ? "" : "the first ", "at ", first->time, " s, ",
                first->place, "\n");
}

/// A run must not overwrite what it is made from.
void checkOutputs(const RunCommandOptions& options, std::vector<std::filesystem::path> read)
{
    const RunDef& run = options.run;
    if (!run.motion.empty()) read.emplace_back(run.motion);
    std::error_code none;
    for (const auto& [option, file] : {std::pair{"--measures", options.measures},
                                       {"--sensors", options.sensors},
                                       {"--log", run.log},
                                       {"--record-motion", run.recordMotion},
                                       {"--picture", run.picture}})
        for (const std::filesystem::path& each : read)
            if (!file.empty() && std::filesystem::equivalent(each, file, none))
                fail("run: ", option, " ", shownWord(file), ": the run reads this file");
}

int runFile(const RunCommandOptions& options)
{
    const RunCommandOptions standard;
    checkDefault("--tets", options.bunny.tets, standard.bunny.tets);
    checkDefault("--subdivision", options.bunny.subdivision, standard.bunny.subdivision);
    checkDefault("--rate", options.rate, standard.rate);
    const auto load = [&] {
        LoadedScene scene{.since = std::filesystem::file_time_type::clock::now()};
        scene.def = scene::loadAnyScene(options.scene, options.import.options());
        checkOutputs(options, scene.def.files);
        if (options.threads != 0) scene.def.physics.threads = givenThreads(options.threads);
        SimulationDef simulation = scene::simulationDef(scene.def);
        simulation.engine = options.engine;
        scene.simulation = std::make_unique<runtime::Simulation>(simulation);
        scene.added =
            scene::addScene(*scene.simulation, scene.def,
                            {.file = options.measures, .session = {.trainee = options.run.trainee}}, options.sensors);
        return scene;
    };
    LoadedScene scene = load();
    const bool watched = options.measures.empty() && options.sensors.empty() && isWatched(options.run);
    const RunReport report = watched ? runReloading(scene, options, load) : scene.simulation->run(options.run);
    if (scene.added.task) scene.added.task->leave();
    if (scene.added.tracker) scene.added.tracker->close();
    if (scene.added.sensors) scene.added.sensors->close();
    const int code = print(report, options);
    if (scene.added.task) std::cout << unfinishedLine(*scene.added.task);
    if (!options.sensors.empty()) std::cout << sensorsLine(*scene.added.sensors, options.sensors);
    for (const auto& progress : scene.added.knots) std::cout << knotLine(progress());
    if (options.run.steps > 0) std::cout << lateCommandsLine(scene.def.commands, report);
    return code;
}

int runScene(RunCommandOptions& options)
{
    if (options.run.headless && options.run.steps == 0) options.run.steps = 1000; // it would never end otherwise
    if (std::ranges::find(kSceneFiles, options.scene) != kSceneFiles.end())
        options.scene = runtime::asset(text("scenes/", options.scene, ".json"));
    if (scene::isSceneFile(options.scene)) return runFile(options);
    const Scene& scene = sceneOf(options);
    const char* fileOnly = options.import.given()      ? options.import.given()
                           : !options.measures.empty() ? "--measures"
                           : !options.sensors.empty()  ? "--sensors"
                                                       : nullptr;
    if (fileOnly) fail("run: ", fileOnly, " applies to scene files, not to '", scene.name, "'");
    if (options.scene != "bunny" && options.bunny.tets != BunnyDef{}.tets)
        fail("run: --tets applies to the bunny, not to '", scene.name, "'");
    SimulationDef def{.physics = {.rate = options.rate, .threads = givenThreads(options.threads)}};
    def.window.title = text("Filasofia: ", scene.name);
    def.look.around = scene.around;
    def.engine = options.engine;
    Simulation sim(def);
    scene.make(sim, options.bunny);
    return print(sim.run(options.run), options);
}

/// An option whose value has a legal range.
Option bounded(std::string name, OptionTarget target, Bound bound, std::string meaning, std::string type = {})
{
    return {.name = std::move(name),
            .target = target,
            .meaning = std::move(meaning),
            .type = std::move(type),
            .bound = bound};
}

constexpr const char* kSceneMeaning = "a scene file (.json, .urdf, MuJoCo's .xml, SOFA's .scn), or bunny (pinned at "
                                      "the head, hanging by its own weight), poke, "
                                      "grasp, friction, cut, tear, haptics or suture (a stitch with the mouse)";

std::vector<Option> optionsOf(RunCommandOptions& o)
{
    std::vector<Option> options = {
        {.name = "SCENE", .target = &o.scene, .meaning = kSceneMeaning, .required = true},
        {.name = "--tets",
         .target = &o.bunny.tets,
         .meaning = "Number of the bunny's tetrahedra: 756, 1492, 3004, 10000 or 30000",
         .choices = bunnySizes()},
        bounded("--subdivision", &o.bunny.subdivision, boundOf(&runtime::ShowDef::subdivision),
                "Subdivision levels of the drawn surface, 0 to 3"),
        bounded("--rate", &o.rate, boundOf(&runtime::PhysicsDef::rate), "Physics steps per second", "HZ"),
        {"--headless", &o.run.headless, "No window and no clock: every run makes the same steps"},
        bounded("--steps", &o.run.steps, boundOf(&RunDef::steps),
                "End after this many steps; 0: no end (headless: 1000)"),
        bounded("--seconds", &o.run.seconds, boundOf(&RunDef::seconds),
                "End after this many seconds of wall time; 0: no end", "S"),
        {"--picture", &o.run.picture, "Write a picture of the last state to this PNG file", "FILE"},
        bounded("--picture-every", &o.run.pictureEvery, boundOf(&RunDef::pictureEvery),
                "Headless: seconds of simulated time between numbered pictures; 0: only the last", "S"),
        {"--video", &o.run.video, "Write the view to this file: .avi, or .mp4 (needs ffmpeg)", "FILE"},
        bounded("--fps", &o.run.fps, boundOf(&RunDef::fps), "Pictures per second of the video"),
        {"--log", &o.run.log, "Write one line per step to this CSV file", "FILE"},
        {"--record", &o.run.record, "Record the run in this .rec file, for replay", "FILE"},
        bounded("--seed", &o.run.seed, boundOf(&RunDef::seed), "Noted in the recording: seed of the random choices"),
        {"--session", &o.run.session, "Noted in the recording: name of the run", "NAME"},
        {"--trainee", &o.run.trainee, "Noted in the recording: name of the trainee", "NAME"},
        {"--device", &o.run.device, "haptics only: the device, NAME or NAME:LIBRARY", "NAME"},
        {"--motion", &o.run.motion, "haptics only: play this motion file", "FILE"},
        {"--record-motion", &o.run.recordMotion, "haptics only: record the hand's motion in this file", "FILE"},
        bounded("--threads", &o.threads, kThreads, "Threads within one step; 0: all cores except one, at most 8"),
        {.name = "--engine",
         .target = &o.engine,
         .meaning = "Physics engine (docs/guide/sofa.md)",
         .choices = runtime::engineNames()},
        {"--measures", &o.measures,
         "Write what a scene file measures to this .jsonl file, for report, or to a .csv file", "FILE"},
        {"--fail-on-warnings", &o.failOnWarnings,
         "Exit code 1 if a step went wrong: a solver at its limit, elements inside out, bodies in each other, unrest "
         "..."},
        {"--sensors", &o.sensors, "Write what the sensors of a scene file read over time (.csv)", "FILE"},
    };
    addOptions(o.import, options);
    return options;
}

} // namespace

Command runCommand()
{
    // Static: there is one command line, and its targets must outlive this function.
    static RunCommandOptions options;
    return {.name = "run",
            .meaning = "Run a scene in a window (Space pauses, Escape ends; more below), or headless",
            .options = optionsOf(options),
            .run = [] { return runScene(options); },
            .footer = "Mouse and keys in the window:\n" + runtime::keyHelp()};
}

} // namespace filasofia::app
