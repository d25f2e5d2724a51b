#include <filasofia/filasofia.h>

using namespace filasofia;

int main(int argc, char** argv)
try {
    Simulation sim({.physics = {.gravity = {}}, .window = {"Cut", 640, 480}});
    const BodyId hand = sim.add(RigidBodyDef{.name = "hand"}); // pulls the tissue tight
    SoftBodyDef def{.name = "skin", .mesh = shapes::block({0.1, 0.02, 0.06}, {26, 5, 15}), .dynamicTopology = true};
    def.attachments = {{.box = Box{{-1, -1, -1}, {1, 1, -.029}}}, {.box = Box{{-1, -1, .029}, {1, 1, 1}}, .to = hand}};
    const BodyId skin = sim.add(def);
    const auto blade = std::make_shared<TriangleMesh>(); // its outline cuts
    blade->vertices = {{}, {4_mm, 0.4_mm}, {8.5_mm, 3_mm}, {20_mm, 14_mm}, {16_mm, 18_mm}, {4_mm, 7_mm}};
    blade->triangles = {{0, 1, 2}, {0, 2, 5}, {2, 3, 5}, {3, 4, 5}};
    const RigidBodyDef tool{.name = "scalpel", .elements = {{}, {}}, .collision = {{.mesh = blade, .cutting = true}}};
    const BodyId scalpel = sim.add(tool);
    sim.show(skin, {.subdivision = 2, .interior = TissueMaterial{.baseColor = {0.4, 0.02, 0.015}, .wetness = 1}});
    sim.show(scalpel, {.surface = blade, .material = MetalMaterial{}});
    sim.show(scalpel, {.surface = shapes::capsule(3.5_mm, 90_mm), .element = 1, .material = MetalMaterial{}});
    sim.dress([](VisualServer& server) {
        addEndoscopeLook(server, {{-28_mm, -4_mm, -16_mm}, {30_mm, 10_mm, 20_mm}}, Quality::High, {-0.15, 1.0, 0.9});
        server.setEnvironment({.intensity = 300, .lampSize = 0.8, .lampDirection = {0, 1, -1}}); // for the steel
    });
    sim.everyStep([&](double t) { // the hand pulls, the blade comes down and moves along its path
        sim.physics().setPose(hand, {{0, 0, std::min(50_mm * t, 16_mm)}});
        const Vec3 tip{std::clamp(43_mm * t - 45_mm, -27_mm, 15_mm), std::max(60_mm - 153_mm * t, -1_mm), 8_mm};
        sim.physics().setPose(scalpel, {tip});
        sim.physics().setPose(scalpel, {tip + Vec3{48_mm, 46_mm, 0}, axisAngle({0, 0, 1}, -45_deg)}, 1); // the handle
    });
    double area = 0.0;
    sim.on<CutEvent>([&](const CutEvent& cut) {
        sim.paint(skin, {.place = cut.rupture.place, .radius = 5_mm, .state = {.blood = 0.3, .wetness = 1.0}});
        std::printf("opened %6.2f mm^2, %.0f in total\n", cut.rupture.area * 1e6, (area += cut.rupture.area) * 1e6);
    });
    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 1500: see --help
    const auto frame = sim.physics().latest();
    return !frame || frame->time < 1.4 || (area > 500e-6 && area < 1000e-6) ? 0 : 1; // it made a cut of 58 x 11 mm
} catch (const Error& error) {
    return report(error);
}
