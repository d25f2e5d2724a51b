#include <filasofia/filasofia.h>

using namespace filasofia;

int main(int argc, char** argv)
try {
    Simulation sim({.physics = {.gravity = {}}, .window = {"An organ in finer detail than its mesh"}});
    const BodyId hand = sim.add(RigidBodyDef{.name = "hand"}); // pulls the two ends apart
    const BodyId bunny = sim.add(SoftBodyDef{
        .name = "bunny",
        .mesh = asset("meshes/bunny_3004.msh"), // the mesh that physics uses
        .material = FemMaterial{.youngModulus = 10_kPa, .poissonRatio = 0.45},
        .attachments = {{.box = Box{{-1, -1, -1}, {-0.07, 1, 1}}}, {.box = Box{{0.04, -1, -1}, {1, 1, 1}}, .to = hand}},
        .dynamicTopology = true,
    });
    const auto blade = std::make_shared<TriangleMesh>(); // an upright plane; its outline cuts
    blade->vertices = {{0, 0, -0.1}, {0, 0, 0.1}, {0, 0.2, 0.1}, {0, 0.2, -0.1}};
    blade->triangles = {{0, 1, 2}, {0, 2, 3}};
    const BodyId tool = sim.add(RigidBodyDef{.name = "blade", .collision = {{.mesh = blade, .cutting = true}}});
    sim.show(bunny, {.surface = asset("meshes/bunny.obj"), // the surface that is drawn: it opens where the mesh is cut
                     .subdivision = 1,
                     .interior = TissueMaterial{.baseColor = {0.4, 0.02, 0.015}, .wetness = 1}});
    sim.dress([](VisualServer& server) {
        addEndoscopeLook(server, {{-0.08, 0.0, -0.03}, {0.09, 0.12, 0.03}}, Quality::High, {-0.3, 0.5, 1.0});
    });
    sim.everyStep([&](double t) {
        sim.physics().setPose(hand, {{std::min(80_mm * t, 40_mm), 0, 0}});
        sim.physics().setPose(tool, {{0.012, 0.2 - std::min(0.25 * t, 0.2), 0}});
    });
    int pieces = 0;
    sim.on<CutEvent>([&](const CutEvent& cut) {
        for (const LoosePiece& piece : cut.rupture.detached)
            std::printf("piece %d came loose: %.0f g\n", ++pieces, piece.mass * 1e3);
    });
    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 1000: see --help
    const auto frame = sim.physics().latest();
    return !frame || frame->time < 0.9 || pieces > 0 ? 0 : 1; // the bunny is in two pieces
} catch (const Error& error) {
    return report(error);
}
