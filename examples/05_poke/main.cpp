#include <filasofia/filasofia.h>

using namespace filasofia;

int main(int argc, char** argv)
try {
    Simulation sim({.window = {.title = "Poke"}});
    const BodyId tissue = sim.add(SoftBodyDef{
        .name = "tissue",
        .mesh = shapes::block({60_mm, 30_mm, 60_mm}, {10, 6, 10}),
        .material = FemMaterial{.youngModulus = 10_kPa, .poissonRatio = 0.4},
        .attachments = {{.box = Box{{-1, -1, -1}, {1, -14.9_mm, 1}}}}, // pinned at its bottom
        .collision = {{}},
    });
    RigidBodyDef tool{.name = "ball", .elements = {{{0, 30_mm, 0}}}, .mesh = shapes::sphere(8_mm), .collision = {{}}};
    const BodyId ball = sim.add(tool);
    sim.show(tissue, {.subdivision = 1});
    sim.show(ball, {.material = MetalMaterial{}});

    // One poke a second. A pose set before a step is reached at the end of that step.
    const auto depthAt = [](double time) { return 3_mm - 8_mm * std::cos(2 * std::numbers::pi * time); };
    sim.everyStep([&](double time) { sim.physics().setPose(ball, {{0, 15_mm + 8_mm - depthAt(time), 0}}); });

    double force = 0.0, shallow = 0.0, deepest = 0.0, next = 0.0;
    sim.on<ContactEvent>([&](const ContactEvent& touch) { force = touch.pair.normalForce; });
    sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent& update) {
        const double depth = depthAt(update.time);
        if (depth < 5_mm) shallow = std::max(shallow, force);
        deepest = std::max(deepest, force);
        if (update.time < next) return;
        std::printf("%4.1f s: the ball is %5.1f mm deep and presses with %.3f N\n", update.time, depth * 1e3, force);
        next += 0.1;
    });
    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 1000: see --help
    const auto frame = sim.physics().latest();
    if (!frame || frame->time < 1.0) return 0; // by then it has poked once and let go
    return shallow > 0.02 && deepest > 1.5 * shallow && (force == 0.0 || depthAt(frame->time) > 0.0) ? 0 : 1;
} catch (const Error& error) {
    return report(error);
}
