#include <filasofia/filasofia.h>

using namespace filasofia;

int main(int argc, char** argv)
try {
    Simulation sim({.window = {"Views", 640, 480}});
    const auto organ = [&](const char* name, Vec3 half, Vec3 place, const Material& material) { // an ellipsoid
        auto shape = std::make_shared<TriangleMesh>(*shapes::sphere(1.0, 32));
        for (Vec3& v : shape->vertices) v = {half.x * v.x, half.y * v.y, half.z * v.z};
        sim.show(sim.add(RigidBodyDef{.name = name, .elements = {{place}}, .mesh = shape}), {.material = material});
    };
    organ("wall", {200_mm, 30_mm, 160_mm}, {0, -32_mm, -60_mm}, MucosaMaterial{});
    organ("liver", {34_mm, 22_mm, 24_mm}, {-28_mm, 12_mm, -8_mm}, TissueMaterial{});
    organ("kidney", {24_mm, 15_mm, 17_mm}, {32_mm, 8_mm, -6_mm}, TissueMaterial{.baseColor = {0.4, 0.1, 0.08}});
    const Pose shaft{{0, 0, 103_mm}, axisAngle({1, 0, 0}, 90_deg)}; // from its tip, which looks along -z
    const auto tipAt = [](double t) { return lookAt({30_mm * std::sin(t), 62_mm, 62_mm}, {0, 6_mm, -4_mm}); };
    const BodyId scope = sim.add(RigidBodyDef{.name = "scope", .mesh = shapes::cylinder(5_mm, 200_mm, 16)});
    sim.show(scope, {.material = MetalMaterial{}});
    sim.everyStep([&](double t) { sim.physics().setPose(scope, tipAt(t) * shaft); });
    sim.dress([&](VisualServer& server) {
        const EndoscopeLook look = addEndoscopeLook(server, {{-45_mm, 0, -20_mm}, {45_mm, 40_mm, 20_mm}});
        sim.follow(*look.rig, scope, {.offset = inverse(shaft)});
        Effects optics = effectsOf(Quality::High);
        optics.endoscope = EndoscopeOptics{};
        look.view->set({.effects = optics});
        Camera& outside = server.add(CameraDef{.name = "outside", .verticalFieldOfView = 25_deg});
        outside.setPose(lookAt({0.5, 0.35, 0.3}, {0, 40_mm, 30_mm}));
        server.add(ViewDef{.name = "overview", .viewport = {0.755, 0.02, 0.235, 0.235}}, outside);
        server.setEnvironment({.intensity = 300, .lampSize = 0.8, .lampDirection = {0.3, 1, 0.5}});
    });
    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 800: see --help
    const auto frame = sim.physics().latest();
    if (!frame) return 0; // --help
    const Vec3 place = frame->rigidBody(scope)->poses[0].position, wanted = (tipAt(frame->time) * shaft).position;
    return distance(place, wanted) < 1e-9 ? 0 : 1;
} catch (const Error& error) {
    return report(error);
}
