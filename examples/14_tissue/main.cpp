#include <filasofia/filasofia.h>

using namespace filasofia;

int main(int argc, char** argv)
try {
    Simulation sim({.physics = {.gravity = {}}, .window = {"Tissue", 640, 480}});
    SoftBodyDef def{.name = "flap", .mesh = shapes::block({80_mm, 8_mm, 24_mm}, {30, 4, 9})};
    def.material = FemMaterial{.youngModulus = 20_kPa,
                               .regions = {{.where = NearSurface{1.5_mm}, .youngModulus = 40_kPa}},
                               .fibres = {{.stiffness = 5_kPa,
                                           .dispersion = 0.1,
                                           .direction = Along{{1, 0, 0}},
                                           .where = Box{{-1, 0, -1}, {1, 1, 1}}}}, // muscle in its upper half
                               .relaxation = {{.share = 0.3, .time = 0.2}}};
    def.attachments = {{.box = Box{{-1, -1, -1}, {-39_mm, 1, 1}}}};
    const BodyId flap = sim.add(def);
    sim.show(flap, {.subdivision = 2});
    sim.dress([](VisualServer& server) {
        addEndoscopeLook(server, {{-42_mm, -6_mm, -14_mm}, {16_mm, 40_mm, 14_mm}}, Quality::High, {0.3, 0.5, 1.0});
    });
    const Ball tip{.centre = {4_mm, 2_mm, 12_mm}, .radius = 7_mm}; // burnt by a cautery
    sim.physics().setTissue(flap,
                            {.where = tip, .youngModulus = 80_kPa, .restScale = 0.8}); // heat stiffens and shrinks
    sim.everyStep([&](double t) {
        sim.physics().setFibreStress(flap, 0, 8_kPa * std::clamp(t - 0.2, 0.0, 1.0)); // the muscle contracts
    });
    sim.paint(flap, {.place = tip.centre, .atRest = true, .radius = 9_mm, .state = {.burn = 1}});
    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 1500: see --help
    const auto frame = sim.physics().latest();
    if (!frame || frame->time < 1.4) return 0;
    const auto& nodes = frame->softBodies.at(0).positions;
    const auto top = std::ranges::max_element(nodes, {}, &Vec3::y);
    return top->y > 20_mm && top->y < 60_mm ? 0 : 1; // the end of the flap was lifted
} catch (const Error& error) {
    return report(error);
}
