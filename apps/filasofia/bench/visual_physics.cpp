#include "apps/filasofia/bench/visual_physics.h"

#include "apps/filasofia/bunny_scene.h"

namespace filasofia::app {

runtime::RunReport runBeside(Beside what, bool freeRunning, double seconds)
{
    Simulation sim({.physics = {.rate = 1000.0},
                    .window = {.width = 640, .height = 480},
                    .look = {.around = bunnyRoom(), .quality = visual::Quality::Low}});
    addBunny(sim, {.tets = 3004, .subdivision = 1, .shown = what != Beside::Nothing});
    return sim.run(RunDef{.backend = what == Beside::Picture ? visual::Backend::Headless : visual::Backend::Null,
                          .seconds = seconds,
                          .freeRunning = freeRunning});
}

} // namespace filasofia::app
