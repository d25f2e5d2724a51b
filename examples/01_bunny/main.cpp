#include <filasofia/filasofia.h>

using namespace filasofia;

int main(int argc, char** argv)
try {
    Simulation sim({.physics = {.rate = 1_kHz, .slack = 2_ms}, .window = {.title = "Bunny"}});
    const BodyId bunny = sim.add(SoftBodyDef{
        .name = "bunny",
        .mesh = asset("meshes/bunny_3004.msh"),
        .material = FemMaterial{.youngModulus = 10_kPa, .poissonRatio = 0.45},
        .attachments = {{.box = Box{{-1, 0.105, -1}, {1, 1, 1}}}}, // pinned at the head
    });
    sim.show(bunny, {.surface = asset("meshes/bunny.obj"), .subdivision = 1});

    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 300, --picture p.png: see --help
    const auto frame = sim.physics().latest();
    if (!frame) return 0; // --help
    const auto lowest = std::ranges::min(frame->softBody(bunny)->positions, {}, &Vec3::y);
    std::printf("after %.3f s the lowest point hangs at %.1f mm\n", frame->time, lowest.y * 1e3);
    return frame->time < 0.2 || lowest.y < -0.02 ? 0 : 1; // by then it has sunk, or something is wrong
} catch (const Error& error) {
    return report(error);
}
