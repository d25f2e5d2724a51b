#include <filasofia/filasofia.h>

using namespace filasofia;

int main(int argc, char** argv)
try {
    Simulation sim(
        {.physics = {.rate = 500},
         .window = {"Burn", 960, 720},
         .look = {.around = Box{{-30_mm, -12_mm, -20_mm}, {30_mm, 12_mm, 20_mm}}, .direction = {0.1, 1, 0.6}}});
    SoftBodyDef def{.name = "lobe", .mesh = shapes::block({0.08, 0.014, 0.06}, {32, 5, 24}), .dynamicTopology = true};
    def.material = FemMaterial{.youngModulus = 8_kPa, .poissonRatio = 0.45};
    def.attachments = {{.box = Box{{-1, -1, -1}, {1, -4.2_mm, 1}}}}; // its lower side lies on what is below it
    const BodyId lobe = sim.add(def);
    RigidBodyDef edge{.name = "hook"};
    edge.collision = {{.mesh = shapes::sheet(6_mm, 20_mm, {1, 1}), .cutting = true}};
    edge.elements[0] = {{0, 60_mm, 0}, axisAngle({1, 0, 0}, 90_deg)};
    const BodyId hook = sim.add(edge);
    sim.show(lobe, {.subdivision = 1, .material = TissueMaterial{.baseColor = {0.40, 0.10, 0.08}}});

    sim.bleed(lobe, {.flux = 1.5e-3, .clottingTime = 60.0});
    sim.burn(lobe, {.depth = 0.5_mm});

    sim.everyStep([&](double t) { // down into the tissue, along it, and away; with current in the first half
        const double down = std::clamp(t / 0.3, 0.0, 1.0), along = std::clamp((t - 0.3) / 4.0, 0.0, 1.0);
        const double away = std::clamp((t - 4.3) / 0.3, 0.0, 1.0);
        const Vec3 place{-24_mm + 48_mm * along, 30_mm - 17_mm * down + 60_mm * away, 0};
        sim.physics().setPose(hook, {place, edge.elements[0].orientation});
        const bool pedal = t > 0.2 && along < 0.5;
        sim.treat(lobe, Heat{.place = place - Vec3{0, 8_mm, 0}, .radius = 4_mm, .power = pedal ? 100.0 : 0.0});
    });
    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 3000: see --help
    const HeatBalance heat = sim.heat(lobe);
    std::printf("burnt %.0f mm^2, %.0f mm^2 of it charred; %.2f ml of blood lost\n", heat.burnt * 1e6,
                heat.charred * 1e6, sim.blood(lobe).welled * 1e6);
    const auto frame = sim.physics().latest();
    return !frame || frame->time < 5.9 || (heat.burnt > 50e-6 && heat.burnt < 900e-6) ? 0 : 1;
} catch (const Error& error) {
    return report(error);
}
