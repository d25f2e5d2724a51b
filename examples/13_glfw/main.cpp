#include <filasofia/filasofia.h>

#include "glfw_window.h" // copy it

#include <atomic>

using namespace filasofia;

int main(int argc, char** argv)
try {
    Simulation sim({.window = {"A window of GLFW", 480, 360}});
    bool opened = false;
    std::atomic<int> drawn = 0; // events come on a thread of their own
    sim.useWindow([&](const window::WindowDef& def) {
        opened = true;
        return std::make_unique<GlfwWindow>(def);
    });
    sim.on<VisualUpdateEvent>([&](const VisualUpdateEvent&) { ++drawn; });
    const BodyId organ = sim.add(SoftBodyDef{.name = "organ",
                                             .mesh = shapes::block({60_mm, 40_mm, 40_mm}, {6, 4, 4}),
                                             .material = FemMaterial{.youngModulus = 5_kPa, .poissonRatio = 0.45},
                                             .attachments = {{.box = Box{{-1, -1, -1}, {-25_mm, 1, 1}}}}});
    sim.show(organ, {.subdivision = 2});
    if (const int problem = sim.run(argc, argv)) return problem; // --steps 500 ends it: see --help
    const auto frame = sim.physics().latest();
    if (!frame) return 0; // --help
    double lowest = 0.0;
    for (Vec3 p : frame->softBody(organ)->positions) lowest = std::min(lowest, p.y);
    std::printf("%d pictures in a window of GLFW\n", drawn.load());
    return lowest < -20.5_mm && opened == (drawn > 0) ? 0 : 1; // its free end hangs, and it was seen
} catch (const Error& error) {
    return report(error);
}
