#include <filasofia/filasofia.h>

using namespace filasofia;

/// Where the loop is: three strokes beside each other, each out over the tissue, down into it and back to the scope.
Vec3 loopAt(double t)
{
    const auto part = [t](double from, double to) { return std::clamp((t - from) / (to - from), 0.0, 1.0); };
    Vec3 at = {-5_mm + 5_mm * (part(1.8, 2.0) + part(3.8, 4.0)), 0, 0};
    for (const double start : {0.0, 2.0, 4.0}) {
        at.y -= 6_mm * (part(start + 0.3, start + 0.5) - part(start + 1.6, start + 1.8));
        at.z += 24_mm * (part(start + 0.5, start + 1.6) - part(start + 1.6, start + 1.8));
    }
    return at + Vec3{0, 9.6_mm, -12_mm};
}

int main(int argc, char** argv)
try {
    Simulation sim(
        {.physics = {.rate = 500, .gravity = {}},
         .window = {"Loop", 960, 720},
         .look = {.around = Box{{-12_mm, -3_mm, -10_mm}, {12_mm, 8_mm, 14_mm}}, .direction = {0.7, 0.9, 1}}});
    SoftBodyDef def{.name = "myoma", .mesh = shapes::block({18_mm, 6_mm, 14_mm}, {15, 5, 12}), .dynamicTopology = true};
    def.material = FemMaterial{.youngModulus = 30_kPa, .poissonRatio = 0.45};
    def.rayleigh = {.mass = 10.0, .stiffness = 0.01};
    def.attachments = {{.box = Box{{-1, -1, -1}, {1, -2.9_mm, 1}}}};
    def.collision = {{.proximity = 0.1_mm, .selfOnceCut = false}};
    const BodyId myoma = sim.add(def);
    sim.show(myoma, {.subdivision = 1,
                     .material = MucosaMaterial{.baseColor = {0.78, 0.42, 0.36}, .noiseScale = 700},
                     .interior = TissueMaterial{.baseColor = {0.85, 0.66, 0.58}}});
    sim.burn(myoma, {.depth = 0.5_mm});
    WireLoop loop(sim, {.pose = {loopAt(0.0), {}}, .cutting = 25.0}); // 6 mm wide

    double removed = 0.0; // [m^3]
    sim.on<CutEvent>([&](const CutEvent& cut) {
        for (const auto& chip : cut.rupture.detached) removed += chip.mass / 1000.0;
    });
    sim.everyStep([&](double t) {
        loop.move({loopAt(t), {}});
        loop.cut(std::fmod(t, 2.0) > 0.4 && std::fmod(t, 2.0) < 1.6); // the yellow pedal
    });
    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 3000: see --help
    const double cut = sim.energy(loop.body()).active - sim.energy(loop.body()).inAir;
    std::printf("%.0f mm^3 shaved off in %.1f s of cutting\n", removed * 1e9, cut);
    const auto frame = sim.physics().latest();
    return !frame || frame->time < 5.9 || (removed > 500e-9 && removed < 700e-9 && cut < 4.0) ? 0 : 1;
} catch (const Error& error) {
    return report(error);
}
