#include <filasofia/filasofia.h>

using namespace filasofia;

int main(int argc, char** argv)
try {
    Simulation sim({.physics = {.gravity = {}}, .window = {"Tear", 640, 480}});
    const BodyId forceps = sim.add(RigidBodyDef{.name = "forceps", .elements = {{}, {}, {}}}); // grip and two jaws
    SoftBodyDef def{.name = "flap", .mesh = shapes::block({0.1, 0.008, 0.06}, {36, 4, 22}), .dynamicTopology = true};
    def.material = FemMaterial{.youngModulus = 15_kPa, .poissonRatio = 0.4, .tearingThreshold = 7_kPa};
    def.rayleigh.mass = 5.0;
    def.attachments = {{.box = Box{{-1, -1, -1}, {1, 1, 0}}}, {.ball = Ball{{0, 0, 28_mm}, 6_mm}, .to = forceps}};
    const BodyId flap = sim.add(def);
    sim.show(flap, {.subdivision = 2, .interior = TissueMaterial{.baseColor = {0.4, 0.02, 0.015}, .wetness = 1}});
    const auto rod = shapes::capsule(1.5_mm, 90_mm);
    for (int jaw : {1, 2}) sim.show(forceps, {.surface = rod, .element = jaw, .material = MetalMaterial{}});
    sim.dress([](VisualServer& server) {
        addEndoscopeLook(server, {{-24_mm, -4_mm, -10_mm}, {24_mm, 16_mm, 42_mm}}, Quality::High, {-0.5, 0.8, 1.0});
        server.setEnvironment({.intensity = 300, .lampSize = 0.8, .lampDirection = {0, 1, -1}});
    });
    const Quat lean = axisAngle({0, 0, 1}, -30_deg) * axisAngle({1, 0, 0}, 45_deg);
    sim.everyStep([&](double t) {
        const Vec3 way = 30_mm * std::clamp(t - 0.1, 0.0, 1.0) * Vec3{0.3, 0.6, 0.8};
        sim.physics().setPose(forceps, {way});
        const Vec3 grip = way + Vec3{0, 0, 24_mm} + rotate(lean, {0, 45_mm, 0});
        for (int jaw : {1, 2}) sim.physics().setPose(forceps, {grip + Vec3{0, jaw == 1 ? -4_mm : 4_mm, 0}, lean}, jaw);
    });
    int loose = 0;
    sim.on<TearEvent>([&](const TearEvent& tear) {
        sim.paint(flap, {.place = tear.rupture.place, .radius = 4_mm, .state = {.blood = 0.4, .wetness = 1.0}});
        std::printf("torn by %5.2f mm^2\n", tear.rupture.area * 1e6);
        for (const LoosePiece& piece : tear.rupture.detached)
            std::printf("piece %d came loose: %zu tetrahedra\n", ++loose, piece.elements.size());
    });
    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 650: see --help
    const auto frame = sim.physics().latest();
    return !frame || frame->time < 0.6 || loose > 0 ? 0 : 1; // the tissue between the forceps has come off
} catch (const Error& error) {
    return report(error);
}
