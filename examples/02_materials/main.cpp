#include <filasofia/filasofia.h>

using namespace filasofia;

int main(int argc, char** argv)
try {
    Simulation sim({.window = {"Materials", 640, 480}});
    const auto put = [&](const char* name, const auto& mesh, Pose pose, const Material& material) {
        const BodyId body = sim.add(RigidBodyDef{.name = name, .elements = {pose}, .mesh = mesh});
        sim.show(body, {.material = material, .castShadows = !std::holds_alternative<GlassMaterial>(material)});
    };
    const auto organ = [](Vec3 half, double dent) { // an ellipsoid of these half axes, with a dent in its middle
        auto shape = std::make_shared<TriangleMesh>(*shapes::sphere(1.0, 32));
        for (Vec3& v : shape->vertices)
            v = {half.x * v.x, half.y * v.y * (1.0 - dent * std::exp(-8.0 * v.x * v.x)), half.z * v.z};
        return shape;
    };
    const Quat alongX = axisAngle({0, 0, 1}, 90_deg);
    const auto turned = [&](double angle) { return axisAngle({0, 1, 0}, angle) * alongX; };
    const Color green{0.03, 0.11, 0.12};
    put("cloth", shapes::box({400_mm, 10_mm, 300_mm}), {{0, -5_mm, 0}},
        TissueMaterial{.baseColor = green, .subsurfaceColor = green, .roughness = 0.9, .wetness = 0, .vessels = 0});
    put("liver", organ({30_mm, 18_mm, 20_mm}, 0.3), {{-27_mm, 16_mm, -20_mm}}, TissueMaterial{});
    put("stomach", organ({24_mm, 15_mm, 17_mm}, 0.2), {{34_mm, 14_mm, -16_mm}}, MucosaMaterial{});
    put("bone", shapes::capsule(6_mm, 40_mm, 24), {{-30_mm, 6_mm, 18_mm}, turned(-15_deg)}, BoneMaterial{});
    put("drop", organ({10_mm, 8_mm, 10_mm}, 0), {{-8_mm, 17_mm, 24_mm}}, GlassMaterial{});
    put("probe", shapes::capsule(2.5_mm, 90_mm, 16), {{22_mm, 2.5_mm, 26_mm}, turned(12_deg)}, MetalMaterial{});
    put("marker", shapes::capsule(2.6_mm, 3_mm, 16), {{42_mm, 2.5_mm, 21.7_mm}, turned(12_deg)},
        UnlitMaterial{.color = {0.05, 0.35, 0.9}});
    sim.dress([](VisualServer& server) {
        addEndoscopeLook(server, {{-48_mm, 0, -20_mm}, {48_mm, 15_mm, 32_mm}}, Quality::High, {0.0, 1.0, 1.0});
        server.setEnvironment({.intensity = 300, .lampSize = 0.6, .lampDirection = {-0.4, 1, -0.6}});
    });
    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 1 --picture p.png: see --help
    const auto frame = sim.physics().latest();
    return !frame || frame->rigidBodies.size() == 7 ? 0 : 1; // all of them are there
} catch (const Error& error) {
    return report(error);
}
