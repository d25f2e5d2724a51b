#include <filasofia/filasofia.h>

using namespace filasofia;

// A user's program: the smallest installed bunny, pinned at the head, falls for a quarter of a second.
int main()
try {
    Simulation sim({.physics = {.rate = 200_Hz}});
    const BodyId bunny = sim.add(SoftBodyDef{
        .name = "bunny",
        .mesh = MESHES "/bunny_756.msh",
        .material = FemMaterial{.youngModulus = 10_kPa, .poissonRatio = 0.45},
        .attachments = {{.box = Box{{-1, 0.105, -1}, {1, 1, 1}}}},
    });
    const auto lowest = [&] {
        return std::ranges::min(sim.physics().latest()->softBody(bunny)->positions, {}, &Vec3::y).y;
    };
    sim.run(RunDef{.headless = true, .steps = 1});
    const double before = lowest();
    sim.run(RunDef{.headless = true, .steps = 50});
    std::printf("outside the tree the bunny's lowest point went from %.1f to %.1f mm\n", before * 1e3, lowest() * 1e3);
    return lowest() < before - 0.01 ? 0 : 1;
} catch (const Error& error) {
    return report(error);
}
