#include <filasofia/filasofia.h>

using namespace filasofia;

/// Where the hook is: down into the layer, along it, up, onto it once more beside the cut, and away.
Vec3 hookAt(double t)
{
    const auto part = [t](double from, double to) { return std::clamp((t - from) / (to - from), 0.0, 1.0); };
    const double low = 13_mm * (part(0.5, 0.8) - part(4.0, 4.3)) + 10.5_mm * (part(4.6, 4.9) - part(5.6, 5.9));
    return {-16_mm + 32_mm * part(0.8, 4.0) - 16_mm * part(4.3, 4.6), 18_mm - low, 9_mm * part(4.3, 4.6)};
}

int main(int argc, char** argv)
try {
    Simulation sim(
        {.physics = {.rate = 500},
         .window = {"Hook", 960, 720},
         .look = {.around = Box{{-24_mm, -4_mm, -18_mm}, {24_mm, 8_mm, 18_mm}}, .direction = {0.2, 1, 0.7}}});
    const BodyId left = sim.add(RigidBodyDef{.name = "left grasper"});
    const BodyId right = sim.add(RigidBodyDef{.name = "right grasper"});
    SoftBodyDef sheet{
        .name = "layer", .mesh = shapes::block({0.06, 0.003, 0.036}, {30, 2, 18}), .dynamicTopology = true};
    sheet.material = FemMaterial{.youngModulus = 20_kPa, .poissonRatio = 0.45};
    sheet.attachments = {{.box = Box{{-1, -1, -1}, {1, 1, -17_mm}}, .to = left},
                         {.box = Box{{-1, -1, 17_mm}, {1, 1, 1}}, .to = right}};
    const BodyId layer = sim.add(sheet);
    SoftBodyDef below{.name = "bed", .mesh = shapes::block({0.06, 0.01, 0.044}, {20, 2, 15})};
    below.pose.position = {0, -8_mm, 0};
    below.attachments = {{.box = Box{{-1, -1, -1}, {1, -12.9_mm, 1}}}};
    const BodyId bed = sim.add(below);
    RigidBodyDef tool{.name = "hook", .elements = {{hookAt(0.0), axisAngle({1, 0, 0}, 90_deg)}}};
    tool.collision = {{.mesh = shapes::sheet(3_mm, 14_mm, {1, 1}), .cutting = true}};
    const BodyId hook = sim.add(tool);
    sim.show(layer, {.subdivision = 1, .material = TissueMaterial{.baseColor = {0.62, 0.36, 0.28}}});
    sim.show(bed, {.subdivision = 1, .material = TissueMaterial{.baseColor = {0.34, 0.06, 0.05}}});
    sim.show(hook, {.surface = shapes::tube({{0, 0, -40_mm}, {0, 0, 6_mm}, {3_mm, 0, 7_mm}}, 0.6_mm),
                    .material = MetalMaterial{}});

    sim.burn(layer, {.depth = 0.5_mm});
    sim.burn(bed, {.depth = 0.5_mm, .target = false}); // what it gets is an injury
    const ElectrodeTip tip{.from = {0, 0, 3_mm}, .to = {0, 0, 7_mm}};
    const int cuts = sim.addElectrode(hook, {.mode = EnergyMode::Cut, .power = 60.0, .tip = tip});
    const int dries =
        sim.addElectrode(hook, {.mode = EnergyMode::Coagulate, .power = 15.0, .radius = 2.5_mm, .tip = tip});

    sim.everyStep([&](double t) {
        const double apart = 4_mm * std::clamp(t / 0.4, 0.0, 1.0); // the layer is held under tension
        sim.physics().setPose(left, {{0, 0, -apart}});
        sim.physics().setPose(right, {{0, 0, apart}});
        sim.physics().setPose(hook, {hookAt(t), tool.elements[0].orientation});
        sim.activate(hook, t > 0.5 && t < 4.1, cuts); // the yellow pedal, and the blue one
        sim.activate(hook, t > 4.8 && t < 5.6, dries);
    });
    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 3000: see --help
    const double burnt = sim.heat(layer).burnt, air = sim.energy(hook, cuts).inAir;
    std::printf("burnt %.0f mm^2, and %.0f mm^2 of the bed\n", burnt * 1e6, sim.heat(bed).burnt * 1e6);
    const auto frame = sim.physics().latest();
    return !frame || frame->time < 5.9 || (burnt > 50e-6 && burnt < 900e-6 && air < 0.5) ? 0 : 1;
} catch (const Error& error) {
    return report(error);
}
