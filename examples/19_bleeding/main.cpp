#include <filasofia/filasofia.h>

using namespace filasofia;

int main(int argc, char** argv)
try {
    Simulation sim(
        {.physics = {.rate = 500},
         .window = {"Bleeding", 960, 720},
         .look = {.around = Box{{-30_mm, -12_mm, -14_mm}, {30_mm, 12_mm, 26_mm}}, .direction = {0.1, 1, 0.9}}});
    // A lobe of tissue that leans by 30 degrees, so that blood runs down it, and the edge that cuts it.
    const Quat lean = axisAngle({1, 0, 0}, 30_deg);
    SoftBodyDef def{.name = "lobe", .mesh = shapes::block({0.08, 0.014, 0.06}, {28, 5, 21}), .dynamicTopology = true};
    def.pose.orientation = lean;
    def.material = FemMaterial{.youngModulus = 8_kPa, .poissonRatio = 0.45};
    def.attachments = {{.box = Box{{-1, -1, -1}, {1, -4.2_mm, 1}}}}; // its lower side lies on what is below it
    const BodyId lobe = sim.add(def);
    RigidBodyDef knife{.name = "scalpel"};
    knife.elements[0] = {{0, 60_mm, 0}, lean};
    knife.collision = {{.mesh = shapes::sheet(12_mm, 20_mm, {1, 1}), .cutting = true}};
    const BodyId scalpel = sim.add(knife);
    sim.show(lobe, {.subdivision = 1, .material = TissueMaterial{.baseColor = {0.40, 0.10, 0.08}}});

    sim.bleed(lobe, {.flux = 7e-4, .clottingTime = 60.0}); // 4.2 ml per minute and cm^2, until it clots

    const Quat upright = lean * axisAngle({1, 0, 0}, 90_deg); // the sheet stands on its long edge
    sim.everyStep([&](double t) {                             // down into the tissue, along it, and away
        const double down = std::clamp(t / 0.3, 0.0, 1.0), along = std::clamp((t - 0.3) / 0.7, 0.0, 1.0);
        const double away = std::clamp((t - 1.0) / 0.3, 0.0, 1.0);
        const Vec3 place{-22_mm + 44_mm * along, 30_mm - 21_mm * down + 60_mm * away, -12_mm};
        sim.physics().setPose(scalpel, {rotate(lean, place), upright});
    });
    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 3000: see --help
    const BloodBalance blood = sim.blood(lobe);
    std::printf("%.2f ml lost, %.2f ml of it on the tissue\n", blood.welled * 1e6, blood.onTissue * 1e6);
    const auto frame = sim.physics().latest();
    return !frame || frame->time < 5.9 || (blood.welled > 0.5e-6 && blood.welled < 10e-6) ? 0 : 1;
} catch (const Error& error) {
    return report(error);
}
