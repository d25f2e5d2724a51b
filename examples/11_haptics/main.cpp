#include <filasofia/filasofia.h>

using namespace filasofia;

int main(int argc, char** argv)
try {
    Simulation sim({.window = {.title = "Haptics"}});
    const BodyId tissue = sim.add(SoftBodyDef{
        .name = "tissue",
        .mesh = shapes::block({60_mm, 30_mm, 60_mm}, {10, 6, 10}),
        .material = FemMaterial{.youngModulus = 10_kPa, .poissonRatio = 0.4},
        .attachments = {{.box = Box{{-1, -1, -1}, {1, -14.9_mm, 1}}}}, // pinned at its bottom
        .collision = {{}},
    });
    const BodyId tool = sim.add(RigidBodyDef{.name = "tool",
                                             .elements = {{{0, 40_mm, 0}}},
                                             .mesh = shapes::capsule(6_mm, 30_mm),
                                             .dynamic = true,
                                             .mass = TotalMass{0.05},
                                             .gravity = false,
                                             .collision = {{}}});
    sim.show(tissue, {.subdivision = 1});
    sim.show(tool, {.material = MetalMaterial{}});

    // A scripted hand presses twice. docs/guide/devices.md says how to use your own.
    const HapticId hand = sim.add(HapticInterfaceDef{
        .device = ScriptedDevice{asset("motions/press.csv")}, .body = tool, .coupling = {.linearStiffness = 400}});

    double hardest = 0.0;
    sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent& update) {
        const double push = sim.haptic(hand).onHand.force.y;
        if (push < hardest + 0.05) return;
        std::printf("%5.3f s: the hand is pushed up with %.2f N\n", update.time, hardest = push);
    });
    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 1500: see --help
    const auto frame = sim.physics().latest();
    return !frame || frame->time < 1.4 || (hardest > 0.3 && sim.haptic(hand).servo.energy <= 0.0) ? 0 : 1;
} catch (const Error& error) {
    return report(error);
}
