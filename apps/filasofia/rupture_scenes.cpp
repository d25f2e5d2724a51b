#include "apps/filasofia/rupture_scenes.h"

namespace filasofia::app {
namespace {

const TissueMaterial kInterior{.baseColor = {0.4, 0.02, 0.015}, .wetness = 1.0};

/// The usual look with a brighter room, because bare steel shows its surroundings.
void dress(Simulation& sim, const Box& room, Vec3 direction)
{
    sim.dress([&sim, room, direction](VisualServer& server) {
        const EndoscopeLook look = addEndoscopeLook(server, room, Quality::High, direction);
        server.setEnvironment({.intensity = 300.0, .lampSize = 0.8, .lampDirection = {0, 1, -1}});
        sim.steer(*look.rig, {.around = room,
                              .start = look.rig->pose(),
                              .verticalFieldOfView = look.camera->def().verticalFieldOfView,
                              .width = server.width(),
                              .height = server.height()});
    });
}

void bleed(Simulation& sim, BodyId body, Vec3 place)
{
    sim.paint(body, {.place = place, .radius = 5_mm, .state = {.blood = 0.3, .wetness = 1.0}});
}

/// The outline of a blade that leans towards +x. Its tip is the origin.
std::shared_ptr<const TriangleMesh> bladeMesh()
{
    return std::make_shared<const TriangleMesh>(
        TriangleMesh{.vertices = {{}, {4_mm, 0.4_mm}, {8.5_mm, 3_mm}, {20_mm, 14_mm}, {16_mm, 18_mm}, {4_mm, 7_mm}},
                     .triangles = {{0, 1, 2}, {0, 2, 5}, {2, 3, 5}, {3, 4, 5}},
                     .uv = {}});
}

/// [m] Position of the scalpel's tip: from 0.5 s on, a stroke of one second every two seconds; in between it returns
/// above the tissue. After the last stroke it rests above that stroke's end.
Vec3 scalpelTip(double time)
{
    constexpr int kStrokes = 3;
    constexpr double kBeside[kStrokes] = {8_mm, -2_mm, 18_mm}; // the hand has pulled the middle by 8 mm
    const double since = std::max(0.0, time - 0.5);
    const int stroke = std::min(static_cast<int>(since / 2.0), kStrokes - 1);
    const double now = since - 2.0 * stroke;
    const auto ramp = [now](double begin, double end) { return std::clamp((now - begin) / (end - begin), 0.0, 1.0); };
    const bool last = stroke == kStrokes - 1;
    const double x = -27_mm + 42_mm * (ramp(0.2, 1.2) - (last ? 0.0 : ramp(1.4, 1.8)));
    const double depth = ramp(0.0, 0.2) - ramp(1.2, 1.4);
    const double towards = last ? 0.0 : ramp(1.4, 1.8) * (kBeside[stroke + 1] - kBeside[stroke]);
    return {x, 14_mm - 15_mm * depth, kBeside[stroke] + towards};
}

} // namespace

void addCut(Simulation& sim, int subdivision)
{
    dress(sim, kCutRoom, {-0.15, 1.0, 0.9});
    const BodyId hand = sim.add(RigidBodyDef{.name = "hand"}); // pulls the tissue tight
    const BodyId skin = sim.add(SoftBodyDef{.name = "skin",
                                            .mesh = shapes::block({100_mm, 20_mm, 60_mm}, {24, 5, 15}),
                                            .gravity = false,
                                            .attachments = {{.box = Box{{-1, -1, -1}, {1, 1, -29_mm}}},
                                                            {.box = Box{{-1, -1, 29_mm}, {1, 1, 1}}, .to = hand}},
                                            .dynamicTopology = true});
    const auto blade = bladeMesh();
    const Quat lean = axisAngle({0, 0, 1}, -45_deg);
    const auto handleAt = [lean](Vec3 tip) { return Pose{tip + Vec3{48_mm, 46_mm, 0}, lean}; };
    const BodyId scalpel = sim.add(RigidBodyDef{.name = "scalpel",
                                                .elements = {{scalpelTip(0.0)}, handleAt(scalpelTip(0.0))},
                                                .collision = {{.mesh = blade, .cutting = true}}});
    sim.show(skin, {.subdivision = subdivision, .interior = kInterior});
    sim.show(scalpel, {.surface = blade, .material = MetalMaterial{}});
    sim.show(scalpel, {.surface = shapes::capsule(3.5_mm, 90_mm), .element = 1, .material = MetalMaterial{}});
    sim.everyStep([&sim, hand, scalpel, handleAt](double time) {
        sim.physics().setPose(hand, {{0, 0, std::min(50_mm * time, 16_mm)}});
        const Vec3 tip = scalpelTip(time);
        sim.physics().setPose(scalpel, {tip});
        sim.physics().setPose(scalpel, handleAt(tip), 1);
    });
    sim.on<CutEvent>([&sim, skin](const CutEvent& cut) { bleed(sim, skin, cut.rupture.place); });
}

void addTear(Simulation& sim, int subdivision)
{
    dress(sim, kTearRoom, {-0.5, 0.8, 1.0});
    const BodyId forceps = sim.add(RigidBodyDef{.name = "forceps", .elements = {{}, {}, {}}}); // grip and two jaws
    const BodyId flap = sim.add(SoftBodyDef{
        .name = "flap",
        .mesh = shapes::block({100_mm, 8_mm, 60_mm}, {26, 3, 16}),
        .material = FemMaterial{.youngModulus = 15_kPa, .poissonRatio = 0.4, .tearingThreshold = 7_kPa},
        .rayleigh = {.mass = 5.0},
        .gravity = false,
        .attachments = {{.box = Box{{-1, -1, -1}, {1, 1, 0}}}, {.ball = Ball{{0, 0, 28_mm}, 6_mm}, .to = forceps}},
        .dynamicTopology = true});
    sim.show(flap, {.subdivision = subdivision, .interior = kInterior});
    const auto rod = shapes::capsule(1.5_mm, 90_mm);
    for (const int jaw : {1, 2}) sim.show(forceps, {.surface = rod, .element = jaw, .material = MetalMaterial{}});
    const Quat lean = axisAngle({0, 0, 1}, -30_deg) * axisAngle({1, 0, 0}, 45_deg);
    sim.everyStep([&sim, forceps, lean](double time) {
        const Vec3 way = 30_mm * std::clamp(time - 0.1, 0.0, 0.7) * Vec3{0.3, 0.6, 0.8};
        sim.physics().setPose(forceps, {way});
        const Vec3 middle = way + Vec3{0, 0, 24_mm} + rotate(lean, {0, 45_mm, 0});
        for (const int jaw : {1, 2})
            sim.physics().setPose(forceps, {middle + Vec3{0, jaw == 1 ? -4_mm : 4_mm, 0}, lean}, jaw);
    });
    sim.on<TearEvent>([&sim, flap](const TearEvent& tear) { bleed(sim, flap, tear.rupture.place); });
}

} // namespace filasofia::app
