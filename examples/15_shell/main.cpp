#include <filasofia/filasofia.h>

using namespace filasofia;

int main(int argc, char** argv)
try {
    Simulation sim({.window = {"Shell", 640, 480}, .look = {.around = Box{{-0.06, 0, -0.06}, {0.06, 0.06, 0.06}}}});
    SoftBodyDef sheet{.name = "peritoneum", .mesh = shapes::sheet(120_mm, 120_mm, {20, 20})};
    sheet.pose.position.y = 26_mm;
    sheet.material = ShellMaterial{.youngModulus = 60_kPa, .poissonRatio = 0.45, .thickness = 0.5_mm};
    sheet.collision = {{.self = true}};
    const BodyId peritoneum = sim.add(sheet);
    SoftBodyDef soft{.name = "organ", .mesh = shapes::block({60_mm, 20_mm, 40_mm}, {6, 2, 4}), .collision = {{}}};
    soft.pose.position.y = 10.5_mm;
    const BodyId organ = sim.add(soft);
    RigidBodyDef table{.name = "table", .mesh = shapes::box({200_mm, 10_mm, 200_mm}), .collision = {{}}};
    table.elements = {{{0, -5_mm, 0}}};
    const BodyId tip = sim.add(RigidBodyDef{.name = "tip", .mesh = shapes::capsule(2_mm, 20_mm)});
    sim.show(peritoneum, {.material = TissueMaterial{.baseColor = {0.7, 0.45, 0.38}, .vessels = 0.3}});
    sim.show(organ, {.subdivision = 1});
    sim.show(tip, {.material = MetalMaterial{}});
    const Color green{0.1, 0.3, 0.3};
    const TissueMaterial cloth{.baseColor = green, .subsurfaceColor = green, .wetness = 0, .vessels = 0};
    sim.show(sim.add(table), {.material = cloth});

    bool held = false;
    sim.everyStep([&](double time) { // the sheet falls over the organ; at 1 s its middle is seized and lifted by 30 mm
        sim.physics().setPose(tip, {{0, 34_mm + 30_mm * std::clamp(time - 1.0, 0.0, 1.0), 0}});
        if (std::exchange(held, time > 1.0) || !held) return;
        sim.physics().attach(peritoneum, {.ball = Ball{.centre = {0, 22_mm, 0}, .radius = 6_mm}, .to = tip});
    });
    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 2500: see --help
    const auto frame = sim.physics().latest();
    if (!frame || frame->time < 2.4) return 0;
    const auto& nodes = frame->softBody(peritoneum)->positions;
    const auto [low, high] = std::ranges::minmax(nodes, {}, &Vec3::y);
    return high.y > 40_mm && high.y < 60_mm && low.y > 0 && low.y < 15_mm ? 0 : 1; // a tent; its rim hangs
} catch (const Error& error) {
    return report(error);
}
