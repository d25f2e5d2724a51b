#include <filasofia/filasofia.h>

using namespace filasofia;

int main(int argc, char** argv)
try {
    Simulation sim({.window = {"Bladder", 640, 480},
                    .look = {.around = Box{{-0.03, -0.02, -0.02}, {0.03, 0.03, 0.02}}, .direction = {0.2, 0.9, 1}}});
    SoftBodyDef organ{.name = "bladder", .mesh = shapes::bladder({25_mm, 20_mm, 20_mm}, 2_mm, {10, 1})};
    organ.material = FemMaterial{.youngModulus = 30_kPa, .poissonRatio = 0.45};
    organ.cavities = {{.fill = CavityFill::Liquid}};                  // full of water, without pressure
    organ.attachments = {{.box = Box{{-1, -1, -1}, {1, -0.006, 1}}}}; // in its bed
    organ.dynamicTopology = true;                                     // it may be cut
    const BodyId bladder = sim.add(organ);
    const auto above = [](double height) { return Pose{{0.7_mm, height, 9.4_mm}, axisAngle({1, 0, 0}, 90_deg)}; };
    RigidBodyDef knife{.name = "knife", .elements = {above(60_mm)}, .mesh = shapes::box({24_mm, 0.4_mm, 40_mm})};
    knife.collision = {{.mesh = shapes::sheet(24_mm, 40_mm, {1, 1}), .proximity = 0, .cutting = true}}; // its outline
    const BodyId blade = sim.add(knife);
    sim.show(bladder, {.subdivision = 1, .material = TissueMaterial{.vessels = 0.6}});
    sim.show(blade, {.material = MetalMaterial{}});

    sim.physics().setCavity({.id = bladder, .inflow = 20e-6}); // m^3/s
    bool full = false;
    sim.everyStep([&](double time) { // 20 ml flow in within a second; then the blade opens the top
        if (!std::exchange(full, time > 1.0) && full) sim.physics().setCavity({.id = bladder, .inflow = 0.0});
        const double down = time < 1.5 ? std::clamp(time - 1.1, 0.0, 0.4) : std::max(0.0, 1.9 - time);
        sim.physics().setPose(blade, above(60_mm - down / 0.4 * 30_mm));
    });
    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 3000: see --help
    const auto frame = sim.physics().latest();
    if (!frame || frame->cavities.empty()) return 0;
    const frame::Cavity& lumen = frame->cavities.front();
    std::printf("%.1f ml inside at %.0f Pa, %.1f ml flowed out of %.1f mm^2\n", lumen.volume * 1e6, lumen.pressure,
                lumen.lost * 1e6, lumen.opening * 1e6);
    return frame->time < 2.9 || (lumen.open && lumen.lost > 5e-6) ? 0 : 1;
} catch (const Error& error) {
    return report(error);
}
