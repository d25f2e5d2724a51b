#include <filasofia/filasofia.h>

using namespace filasofia;

int main(int argc, char** argv)
try {
    Simulation sim({.physics = {.gravity = {}},
                    .window = {"Catheter", 640, 480},
                    .look = {.around = Box{{-42_mm, -6_mm, -6_mm}, {24_mm, 34_mm, 6_mm}}, .direction = {0.1, 0.2, 1}}});
    std::vector<Vec3> line; // straight, a quarter of a circle, straight
    for (int i = 0; i < 8; ++i) line.push_back({-40_mm + i * 5_mm, 0, 0});
    for (const Vec3& p : shapes::arc(16_mm, -90_deg, 0, 6)) line.push_back(p + Vec3{0, 16_mm, 0});
    for (int i = 1; i < 4; ++i) line.push_back({16_mm, 16_mm + i * 5_mm, 0});
    SoftBodyDef vessel{.name = "vessel", .mesh = shapes::vessel(line, 3_mm, 1_mm, {12, 1}), .friction = 0.05};
    vessel.material = FemMaterial{.youngModulus = 300_kPa, .poissonRatio = 0.45};
    vessel.attachments = {{.box = Box{{-41_mm, -1, -1}, {-38_mm, 1, 1}}}, {.box = Box{{-1, 30_mm, -1}, {1, 1, 1}}}};
    vessel.collision = {{.proximity = 0.3_mm}};
    vessel.rayleigh.mass = 20.0; // what is around it
    const BodyId wall = sim.add(vessel);
    const BodyId hand = sim.add(RigidBodyDef{.name = "hand", .elements = {{{-100_mm, 0, 0}}}});
    RodBodyDef catheter{.name = "catheter", .points = {{-100_mm, 0, 0}, {-34_mm, 0, 0}}, .spacing = 1.5_mm};
    catheter.radius = 0.8_mm;
    catheter.youngModulus = 20_MPa;
    catheter.rayleigh.mass = 20.0;
    catheter.friction = 0.05;
    catheter.attachments = {{.nodes = {0, 1}, .to = hand}}; // it is pushed and turned there
    catheter.collision = RodCollision{.self = false};
    const BodyId tube = sim.add(catheter);
    RigidBodyDef back{.name = "back", .elements = {{{0, 0, -20_mm}}}, .mesh = shapes::box({300_mm, 300_mm, 10_mm})};
    const Color green{0.1, 0.3, 0.3};
    sim.show(sim.add(back),
             {.material = TissueMaterial{.baseColor = green, .subsurfaceColor = green, .wetness = 0, .vessels = 0}});
    sim.show(wall, {.material = GlassMaterial{}});
    sim.show(tube, {.material = TissueMaterial{.baseColor = {0.1, 0.3, 0.6}, .wetness = 0, .vessels = 0}});
    bool steered = false;
    sim.everyStep([&](double time) { // 72 mm in 6 s; before the bend, the tip bends by itself
        sim.physics().setPose(hand, {{-100_mm + 72_mm * std::clamp(time / 6.0, 0.0, 1.0), 0, 0}, {}});
        if (time > 2.0 && !std::exchange(steered, true))
            sim.physics().setCurvature(tube, {{.begin = 50_mm, .curvature = {0, 40}}}, 40);
    });

    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 6500: see --help
    const auto frame = sim.physics().latest();
    if (!frame || frame->time < 6.4) return 0;
    const Vec3 tip = frame->softBody(tube)->positions.back(); // in the second straight part
    std::printf("the tip is at %.1f %.1f %.1f mm\n", 1e3 * tip.x, 1e3 * tip.y, 1e3 * tip.z);
    return distance(tip, {16_mm, tip.y, 0}) < 3_mm && tip.y > 16_mm ? 0 : 1;
} catch (const Error& error) {
    return report(error);
}
