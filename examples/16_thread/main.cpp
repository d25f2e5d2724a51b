#include <filasofia/filasofia.h>

using namespace filasofia;

int main(int argc, char** argv)
try {
    Simulation sim(
        {.window = {"Thread", 640, 480}, .look = {.around = Box{{-0.04, -0.06, -0.03}, {0.04, 0.02, 0.03}}}});
    RodBodyDef thread{.name = "thread", .points = {{-60_mm, 15_mm, -3_mm}, {60_mm, 15_mm, 3_mm}}, .spacing = 1_mm};
    thread.pose.position.x = 8_mm; // one end hangs lower than the other
    thread.radius = 0.5_mm;
    thread.youngModulus = 0.3_MPa;
    thread.rayleigh.mass = 4.0; // the air, so that its ends do not swing for long
    thread.collision = RodCollision{};
    thread.friction = 0.5;
    const BodyId silk = sim.add(thread);
    RigidBodyDef bar{.name = "bar", .mesh = shapes::cylinder(8_mm, 24_mm, 16), .collision = {{}}, .friction = 0.5};
    bar.elements = {{{}, axisAngle({1, 0, 0}, 90_deg)}};
    sim.show(silk);
    sim.show(sim.add(bar), {.material = MetalMaterial{}});
    RigidBodyDef wall{.name = "wall", .elements = {{{0, 0, -30_mm}}}, .mesh = shapes::box({300_mm, 300_mm, 10_mm})};
    const Color green{0.1, 0.3, 0.3};
    const TissueMaterial cloth{.baseColor = green, .subsurfaceColor = green, .wetness = 0, .vessels = 0};
    sim.show(sim.add(wall), {.material = cloth});

    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 2000: see --help
    const auto frame = sim.physics().latest();
    if (!frame || frame->time < 1.9) return 0;
    const auto& nodes = frame->softBody(silk)->positions;
    const auto top = std::ranges::max_element(nodes, {}, &Vec3::y);
    const bool over = top->y > 8.3_mm && top->y < 9_mm && std::abs(top->x) < 2_mm;
    const bool hangs = nodes.front().y < -25_mm && nodes.back().y < nodes.front().y - 5_mm; // friction holds it so
    const auto fast = [](Vec3 v) { return length(v) > 0.03; };
    return over && hangs && std::ranges::none_of(frame->softBody(silk)->velocities, fast) ? 0 : 1;
} catch (const Error& error) {
    return report(error);
}
