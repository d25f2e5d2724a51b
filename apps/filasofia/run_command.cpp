#include "apps/filasofia/bunny_scene.h"
#include "apps/filasofia/commands.h"

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

/// What a person at the window can do.
void bindKeys(Simulation& sim)
{
    sim.on<KeyEvent>([&sim, paused = false](const KeyEvent& key) mutable {
        if (!key.pressed || key.repeat) return;
        if (key.key == KeyCode::Escape) sim.finish("Escape");
        if (key.key == KeyCode::Space) sim.physics().pause(paused = !paused);
        if (key.key == KeyCode::R) sim.physics().reset();
    });
}

int runScene(Options& options)
{
    if (options.scene != "bunny") fail("run: there is no scene '", options.scene, "'; there is bunny");
    if (options.run.headless && options.run.steps == 0) options.run.steps = 1000; // it would never end
    Simulation sim({.physics = {.rate = options.rate, .threads = givenThreads(options.threads)},
                    .window = {.title = "Filasofia: bunny"},
                    .look = {.around = bunnyRoom()}});
    addBunny(sim, options.bunny);
    bindKeys(sim);
    std::cout << runtime::summary(sim.run(options.run));
    return 0;
}

} // namespace

Command runCommand()
{
    static Options options; // there is one command line, and it outlives this function
    return {
        .name = "run",
        .meaning = "Run a scene in a window (Space pauses, R resets, Escape ends), or headless",
        .options = {{"SCENE", &options.scene, "bunny: pinned at the head, falling under its own weight", "", {}, true},
                    {"--tets", &options.bunny.tets, "Tetrahedra: 756, 1492, 3004, 10000 or 30000"},
                    {"--subdivision", &options.bunny.subdivision, "Levels of the drawn surface, 0 to 3"},
                    {"--rate", &options.rate, "Physics steps per second", "HZ"},
                    {"--headless", &options.run.headless, "No window, no clock: the same steps every time"},
                    {"--steps", &options.run.steps, "End after as many steps (headless: 1000 unless given)"},
                    {"--seconds", &options.run.seconds, "End after as many seconds of wall time", "S"},
                    {"--picture", &options.run.picture, "Write the last state to this PNG file", "FILE"},
                    {"--picture-every", &options.run.pictureEvery, "Headless: numbered pictures, seconds apart", "S"},
                    {"--log", &options.run.log, "Write a line per step to this CSV file", "FILE"},
                    {"--record", &options.run.record, "Write the run to this .rec file, for replay", "FILE"},
                    {"--threads", &options.threads, "Threads within one step; 0: the cores but one, up to 8", "N"}},
        .run = [] { return runScene(options); }};
}

} // namespace filasofia::app
