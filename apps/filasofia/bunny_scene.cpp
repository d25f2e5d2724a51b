#include "apps/filasofia/bunny_scene.h"

#include <algorithm>

namespace filasofia::app {

BodyId addBunny(Simulation& sim, const BunnyDef& def)
{
    if (std::find(std::begin(kBunnySizes), std::end(kBunnySizes), def.tets) == std::end(kBunnySizes))
        fail("bunny: tets must be one of 756, 1492, 3004, 10000, 30000, got ", def.tets);
    const BodyId bunny = sim.add(SoftBodyDef{
        .name = "bunny",
        .mesh = asset(text("meshes/bunny_", def.tets, ".msh")),
        .material = FemMaterial{.youngModulus = 10_kPa, .poissonRatio = 0.45},
        .attachments = {{.box = Box{{-1, 0.105, -1}, {1, 1, 1}}}}, // the head and the ears
    });
    if (def.shown) sim.show(bunny, {.surface = asset("meshes/bunny.obj"), .subdivision = def.subdivision});
    return bunny;
}

Box bunnyRoom() { return {{-0.115, -0.058, -0.04}, {0.058, 0.15, 0.04}}; }

} // namespace filasofia::app
