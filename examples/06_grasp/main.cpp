#include <filasofia/filasofia.h>

using namespace filasofia;

int main(int argc, char** argv)
try {
    Simulation sim({.window = {.title = "Grasp"}, .look = {.around = Box{{-0.024, 0, -0.016}, {0.024, 0.056, 0.016}}}});
    SoftBodyDef soft{.name = "cube", .mesh = shapes::block({20_mm, 20_mm, 20_mm}), .collision = {{}}, .friction = 0.6};
    soft.pose.position.y = 10.5_mm;
    const BodyId cube = sim.add(soft);
    RigidBodyDef table{.name = "table", .mesh = shapes::box({80_mm, 10_mm, 60_mm}), .collision = {{}}};
    table.elements = {{{0, -5_mm, 0}}};
    RigidBodyDef jaw{.mesh = shapes::box({4_mm, 12_mm, 16_mm}), .collision = {{}}, .friction = 0.6};
    BodyId jaws[2];
    for (int side : {0, 1}) {
        jaw.name = side ? "right jaw" : "left jaw";
        jaw.elements = {{{side ? 20_mm : -20_mm, 10_mm, 0}}};
        sim.show(jaws[side] = sim.add(jaw), {.material = MetalMaterial{}});
    }
    sim.show(cube, {.subdivision = 1});
    const Color green{0.1, 0.3, 0.3};
    const TissueMaterial cloth{.baseColor = green, .subsurfaceColor = green, .wetness = 0, .vessels = 0};
    sim.show(sim.add(table), {.material = cloth});

    sim.everyStep([&](double time) { // closes until 0.6 s, lifts from 0.8 s to 1.6 s
        const double apart = 20_mm - 9.5_mm * std::clamp(time / 0.6, 0.0, 1.0);
        const double height = 10_mm + 40_mm * std::clamp((time - 0.8) / 0.8, 0.0, 1.0);
        for (int side : {0, 1}) sim.physics().setPose(jaws[side], {{side ? apart : -apart, height, 0}});
    });
    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 2000: see --help
    const auto frame = sim.physics().latest();
    if (!frame) return 0; // --help
    const auto lowest = std::ranges::min(frame->softBody(cube)->positions, {}, &Vec3::y);
    std::printf("after %.3f s the cube is %.1f mm above the table\n", frame->time, lowest.y * 1e3);
    return frame->time < 1.7 || (lowest.y > 35_mm && lowest.y < 42_mm) ? 0 : 1; // lifted by 40 mm, sagging a little
} catch (const Error& error) {
    return report(error);
}
