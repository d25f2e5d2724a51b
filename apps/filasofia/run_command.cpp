#include "apps/filasofia/bunny_scene.h"
#include "apps/filasofia/command_line.h"
#include "apps/filasofia/commands.h"
#include "apps/filasofia/contact_scenes.h"
#include "apps/filasofia/haptic_scene.h"
#include "apps/filasofia/rupture_scenes.h"
#include "filasofia/runtime/keys.h"

#include <iostream>

namespace filasofia::app {
namespace {

struct Options {
    std::string scene;
    BunnyDef bunny;
    double rate = 1000.0;
    int threads = 0;
    RunDef run;
};

/// What can be run by its name.
struct Scene {
    const char* name;
    Box around; ///< what the camera looks at
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

const Scene& sceneOf(const Options& options)
{
    std::string names;
    for (const Scene& scene : kScenes) {
        if (options.scene == scene.name) return scene;
        names += text(names.empty() ? "" : ", ", scene.name);
    }
    fail("run: there is no scene '", shortened(options.scene), "'; there are ", names);
}

std::vector<std::string> bunnySizes()
{
    std::vector<std::string> sizes;
    for (const int size : kBunnySizes) sizes.push_back(text(size));
    return sizes;
}

int runScene(Options& options)
{
    const Scene& scene = sceneOf(options);
    if (options.scene != "bunny" && options.bunny.tets != BunnyDef{}.tets)
        fail("run: --tets is for the bunny, not for '", scene.name, "'");
    if (options.run.headless && options.run.steps == 0) options.run.steps = 1000; // it would never end
    Simulation sim({.physics = {.rate = options.rate, .threads = givenThreads(options.threads)},
                    .window = {.title = text("Filasofia: ", scene.name)},
                    .look = {.around = scene.around}});
    scene.make(sim, options.bunny);
    const RunReport report = sim.run(options.run);
    std::cout << runtime::summary(report);
    return report.fileProblems.empty() ? 0 : kFailed;
}

} // namespace

Command runCommand()
{
    static Options options; // there is one command line, and it outlives this function
    return {.name = "run",
            .meaning = "Run a scene in a window (Space pauses, Escape ends; more below), or headless",
            .options = {{"SCENE",
                         &options.scene,
                         "bunny (pinned at the head, falling by itself), poke, grasp, friction, cut, tear or haptics",
                         "",
                         {},
                         true},
                        {.name = "--tets",
                         .target = &options.bunny.tets,
                         .meaning = "The bunny's tetrahedra: 756, 1492, 3004, 10000 or 30000",
                         .choices = bunnySizes()},
                        {.name = "--subdivision",
                         .target = &options.bunny.subdivision,
                         .meaning = "Levels of the drawn surface, 0 to 3",
                         .bound = boundOf(&runtime::ShowDef::subdivision)},
                        {.name = "--rate",
                         .target = &options.rate,
                         .meaning = "Physics steps per second",
                         .type = "HZ",
                         .bound = boundOf(&runtime::PhysicsDef::rate)},
                        {"--headless", &options.run.headless, "No window, no clock: the same steps every time"},
                        {.name = "--steps",
                         .target = &options.run.steps,
                         .meaning = "End after as many steps; 0: no end (headless: 1000)",
                         .bound = boundOf(&RunDef::steps)},
                        {.name = "--seconds",
                         .target = &options.run.seconds,
                         .meaning = "End after as many seconds of wall time; 0: no end",
                         .type = "S",
                         .bound = boundOf(&RunDef::seconds)},
                        {"--picture", &options.run.picture, "Write the last state to this PNG file", "FILE"},
                        {.name = "--picture-every",
                         .target = &options.run.pictureEvery,
                         .meaning = "Headless: numbered pictures, seconds apart; 0: only the last",
                         .type = "S",
                         .bound = boundOf(&RunDef::pictureEvery)},
                        {"--video", &options.run.video, "Write what is seen to this MP4 file (needs ffmpeg)", "FILE"},
                        {.name = "--fps",
                         .target = &options.run.fps,
                         .meaning = "Pictures per second of the video",
                         .bound = boundOf(&RunDef::fps)},
                        {"--log", &options.run.log, "Write a line per step to this CSV file", "FILE"},
                        {"--record", &options.run.record, "Write the run to this .rec file, for replay", "FILE"},
                        {.name = "--seed",
                         .target = &options.run.seed,
                         .meaning = "Told by the recording: of what is drawn by chance",
                         .bound = boundOf(&RunDef::seed)},
                        {"--session", &options.run.session, "Told by the recording: what the run is called", "NAME"},
                        {"--trainee", &options.run.trainee, "Told by the recording: who is at it", "NAME"},
                        {"--device", &options.run.device, "Of haptics: its device, NAME or NAME:LIBRARY", "NAME"},
                        {"--motion", &options.run.motion, "Of haptics: play this motion file", "FILE"},
                        {"--record-motion", &options.run.recordMotion, "Write the hand's way to it", "FILE"},
                        {.name = "--threads",
                         .target = &options.threads,
                         .meaning = "Threads within one step; 0: the cores but one, up to 8",
                         .bound = kThreads}},
            .run = [] { return runScene(options); },
            .footer = "Mouse and keys in the window:\n" + runtime::keyHelp()};
}

} // namespace filasofia::app
