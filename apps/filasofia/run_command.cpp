#include "apps/filasofia/bunny_scene.h"
#include "apps/filasofia/command_line.h"
#include "apps/filasofia/commands.h"
#include "apps/filasofia/contact_scenes.h"
#include "apps/filasofia/haptic_scene.h"
#include "apps/filasofia/rupture_scenes.h"
#include "apps/filasofia/scene_reload.h"
#include "filasofia/core/log.h"
#include "filasofia/runtime/keys.h"
#include "filasofia/scene/import.h"

#include <filesystem>
#include <iostream>

namespace filasofia::app {
namespace {

struct RunCommandOptions {
    std::string scene;
    BunnyDef bunny;
    double rate = 1000.0;
    int threads = 0;
    bool anyFolder = false, strict = false;
    std::string package;
    std::string measures;
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

const Scene& sceneOf(const RunCommandOptions& options)
{
    std::string names;
    for (const Scene& scene : kScenes) {
        if (options.scene == scene.name) return scene;
        names += text(names.empty() ? "" : ", ", scene.name);
    }
    if (options.scene.find_first_of("./") != std::string::npos)
        fail("run: a scene file has a name that ends in .json, .urdf, .xml or .mjcf, got '", shortened(options.scene),
             "'");
    fail("run: unknown scene '", shortened(options.scene), "'; known are ", names,
         ", and scene files (.json, .urdf, .xml)");
}

std::vector<std::string> bunnySizes()
{
    std::vector<std::string> sizes;
    for (const int size : kBunnySizes) sizes.push_back(text(size));
    return sizes;
}

int print(const RunReport& report)
{
    std::cout << runtime::summary(report);
    return report.complete() ? 0 : kFailed;
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
RunReport runReloading(LoadedScene scene, const RunCommandOptions& options, const std::function<LoadedScene()>& load)
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

scene::ImportOptions importOptions(const RunCommandOptions& options)
{
    scene::ImportOptions import{.anyFolder = options.anyFolder, .strict = options.strict};
    if (!options.package.empty()) import.packages = {options.package};
    return import;
}

int runFile(const RunCommandOptions& options)
{
    const RunCommandOptions standard;
    checkDefault("--tets", options.bunny.tets, standard.bunny.tets);
    checkDefault("--subdivision", options.bunny.subdivision, standard.bunny.subdivision);
    checkDefault("--rate", options.rate, standard.rate);
    const auto load = [&] {
        LoadedScene scene{.since = std::filesystem::file_time_type::clock::now()};
        scene.def = scene::loadAnyScene(options.scene, importOptions(options));
        if (options.threads != 0) scene.def.physics.threads = givenThreads(options.threads);
        scene.simulation = std::make_unique<runtime::Simulation>(scene::simulationDef(scene.def));
        scene.added = scene::addScene(*scene.simulation, scene.def,
                                      {.file = options.measures, .session = {.trainee = options.run.trainee}});
        return scene;
    };
    if (options.measures.empty() && isWatched(options.run)) return print(runReloading(load(), options, load));
    const LoadedScene scene = load();
    const RunReport report = scene.simulation->run(options.run);
    if (scene.added.tracker) scene.added.tracker->close();
    return print(report);
}

int runScene(RunCommandOptions& options)
{
    if (options.run.headless && options.run.steps == 0) options.run.steps = 1000; // it would never end otherwise
    if (scene::isSceneFile(options.scene)) return runFile(options);
    const Scene& scene = sceneOf(options);
    const char* fileOnly = options.anyFolder           ? "--any-folder"
                           : options.strict            ? "--strict"
                           : !options.package.empty()  ? "--package"
                           : !options.measures.empty() ? "--measures"
                                                       : nullptr;
    if (fileOnly) fail("run: ", fileOnly, " applies to scene files, not to '", scene.name, "'");
    if (options.scene != "bunny" && options.bunny.tets != BunnyDef{}.tets)
        fail("run: --tets applies to the bunny, not to '", scene.name, "'");
    Simulation sim({.physics = {.rate = options.rate, .threads = givenThreads(options.threads)},
                    .window = {.title = text("Filasofia: ", scene.name)},
                    .look = {.around = scene.around}});
    scene.make(sim, options.bunny);
    return print(sim.run(options.run));
}

} // namespace

Command runCommand()
{
    // Static: there is one command line, and its targets must outlive this function.
    static RunCommandOptions options;
    return {
        .name = "run",
        .meaning = "Run a scene in a window (Space pauses, Escape ends; more below), or headless",
        .options = {{"SCENE",
                     &options.scene,
                     "a scene file (.json, .urdf, MuJoCo's .xml), or bunny (pinned at the head, hanging by its own "
                     "weight), poke, grasp, "
                     "friction, cut, tear or haptics",
                     "",
                     {},
                     true},
                    {.name = "--tets",
                     .target = &options.bunny.tets,
                     .meaning = "Number of the bunny's tetrahedra: 756, 1492, 3004, 10000 or 30000",
                     .choices = bunnySizes()},
                    {.name = "--subdivision",
                     .target = &options.bunny.subdivision,
                     .meaning = "Subdivision levels of the drawn surface, 0 to 3",
                     .bound = boundOf(&runtime::ShowDef::subdivision)},
                    {.name = "--rate",
                     .target = &options.rate,
                     .meaning = "Physics steps per second",
                     .type = "HZ",
                     .bound = boundOf(&runtime::PhysicsDef::rate)},
                    {"--headless", &options.run.headless, "No window and no clock: every run makes the same steps"},
                    {.name = "--steps",
                     .target = &options.run.steps,
                     .meaning = "End after this many steps; 0: no end (headless: 1000)",
                     .bound = boundOf(&RunDef::steps)},
                    {.name = "--seconds",
                     .target = &options.run.seconds,
                     .meaning = "End after this many seconds of wall time; 0: no end",
                     .type = "S",
                     .bound = boundOf(&RunDef::seconds)},
                    {"--picture", &options.run.picture, "Write a picture of the last state to this PNG file", "FILE"},
                    {.name = "--picture-every",
                     .target = &options.run.pictureEvery,
                     .meaning = "Headless: seconds of simulated time between numbered pictures; 0: only the last",
                     .type = "S",
                     .bound = boundOf(&RunDef::pictureEvery)},
                    {"--video", &options.run.video, "Write the view to this MP4 file (needs ffmpeg)", "FILE"},
                    {.name = "--fps",
                     .target = &options.run.fps,
                     .meaning = "Pictures per second of the video",
                     .bound = boundOf(&RunDef::fps)},
                    {"--log", &options.run.log, "Write one line per step to this CSV file", "FILE"},
                    {"--record", &options.run.record, "Record the run in this .rec file, for replay", "FILE"},
                    {.name = "--seed",
                     .target = &options.run.seed,
                     .meaning = "Noted in the recording: seed of the random choices",
                     .bound = boundOf(&RunDef::seed)},
                    {"--session", &options.run.session, "Noted in the recording: name of the run", "NAME"},
                    {"--trainee", &options.run.trainee, "Noted in the recording: name of the trainee", "NAME"},
                    {"--device", &options.run.device, "haptics only: the device, NAME or NAME:LIBRARY", "NAME"},
                    {"--motion", &options.run.motion, "haptics only: play this motion file", "FILE"},
                    {"--record-motion", &options.run.recordMotion,
                     "haptics only: record the hand's motion in this file", "FILE"},
                    {.name = "--threads",
                     .target = &options.threads,
                     .meaning = "Threads within one step; 0: all cores except one, at most 8",
                     .bound = kThreads},
                    {"--measures", &options.measures,
                     "Write what a scene file measures to this .jsonl file, for report, or to a .csv file", "FILE"},
                    {"--any-folder", &options.anyFolder, "The files that a scene file names may be outside its folder"},
                    {"--strict", &options.strict, "URDF and MJCF: what is not read is an error"},
                    {.name = "--package",
                     .target = &options.package,
                     .meaning = "URDF: the folder of package://NAME, or one that has it",
                     .type = "FOLDER"}},
        .run = [] { return runScene(options); },
        .footer = "Mouse and keys in the window:\n" + runtime::keyHelp()};
}

} // namespace filasofia::app
