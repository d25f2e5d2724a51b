#include <filasofia/filasofia.h>

using namespace filasofia;

int main(int argc, char** argv)
try {
    Simulation sim({.window = {.title = "Friction"}, .look = {.around = Box{{-0.1, -0.04, -0.05}, {0.1, 0.05, 0.05}}}});
    const Color green{0.1, 0.3, 0.3}, brown{0.5, 0.4, 0.2};
    const TissueMaterial cloth{.baseColor = green, .subsurfaceColor = green, .wetness = 0, .vessels = 0};
    const TissueMaterial wood{.baseColor = brown, .subsurfaceColor = brown, .wetness = 0, .vessels = 0};
    const Quat tilt = axisAngle({0, 0, 1}, -20_deg);
    RigidBodyDef slope{
        .name = "slope", .mesh = shapes::box({240_mm, 10_mm, 100_mm}), .collision = {{}}, .friction = 0.5};
    slope.elements = {{rotate(tilt, {0, -5_mm, 0}), tilt}};
    sim.show(sim.add(slope), {.material = cloth});

    // The friction of a pair is the geometric mean; a box slides if it is below tan 20 deg = 0.364.
    RigidBodyDef box{.mesh = shapes::box({30_mm, 20_mm, 30_mm}), .dynamic = true, .collision = {{}}};
    BodyId boxes[2];
    for (int i : {0, 1}) {
        box.name = i ? "smooth box" : "rough box";
        box.elements = {{rotate(tilt, {-80_mm, 10.1_mm, i ? 25_mm : -25_mm}), tilt}};
        box.friction = i ? 0.18 : 0.32; // with the slope's: 0.3 and 0.4
        sim.show(boxes[i] = sim.add(box), {.material = wood});
    }
    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 500: see --help
    const auto frame = sim.physics().latest();
    if (!frame) return 0; // --help
    double moved[2];
    for (int i : {0, 1}) moved[i] = rotate(conjugate(tilt), frame->rigidBody(boxes[i])->poses[0].position).x + 80_mm;
    const double theory = 0.5 * 9.81 * (std::sin(20_deg) - 0.3 * std::cos(20_deg)) * frame->time * frame->time;
    std::printf("after %.3f s the rough box has moved %.3f mm, the smooth one %.1f mm (theory: 0, %.1f)\n", frame->time,
                moved[0] * 1e3, moved[1] * 1e3, theory * 1e3);
    const bool sticks = std::abs(moved[0]) < 0.1_mm, slides = std::abs(moved[1] / theory - 1.0) < 0.1;
    return frame->time < 0.3 || frame->time > 0.7 || (sticks && slides) ? 0 : 1; // after 0.7 s it has left the slope
} catch (const Error& error) {
    return report(error);
}
