#include <filasofia/filasofia.h>

using namespace filasofia;

// A user's program: the smallest installed bunny, pinned at the head, falls for a quarter of a second. The argument is
// the prefix under which the mesh must be found.
int main(int, char** argv)
try {
    const std::string mesh = asset("meshes/bunny_756.msh");
    if (!mesh.starts_with(argv[1])) fail(mesh, " does not lie under ", argv[1]);
    Simulation sim({.physics = {.rate = 200_Hz}});
    const BodyId bunny = sim.add(SoftBodyDef{
        .name = "bunny",
        .mesh = mesh,
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
