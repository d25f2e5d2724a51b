#include "apps/filasofia/contact_scenes.h"

namespace filasofia::app {
namespace {

const visual::Material kSteel = MetalMaterial{.roughness = 0.5};

/// A dry and matt material. Bare metal looks dark if the endoscope's light is not reflected back to the camera.
visual::Material dull(const visual::Color& color)
{
    return TissueMaterial{.baseColor = color,
                          .subsurfaceColor = color,
                          .roughness = 0.8,
                          .wetness = 0.0,
                          .mottling = 0.1,
                          .vessels = 0.0,
                          .bump = 0.1};
}
const visual::Material kCloth = dull({0.10, 0.30, 0.32});
const visual::Material kWood = dull({0.55, 0.42, 0.25});

BodyId addShown(Simulation& sim, RigidBodyDef def, const visual::Material& material)
{
    def.collision = {{}};
    const BodyId id = sim.add(std::move(def));
    sim.show(id, {.material = material});
    return id;
}

/// [-] Goes from 0 to 1 and back in a cycle of 4 s: rises between `begin` and `end` [s] and falls at the mirrored
/// times.
double swing(double time, double begin, double end)
{
    const double now = std::fmod(time, 4.0);
    return std::clamp((std::min(now, 4.0 - now) - begin) / (end - begin), 0.0, 1.0);
}

} // namespace

void addPoke(Simulation& sim, int subdivision)
{
    const BodyId tissue = sim.add(SoftBodyDef{.name = "tissue",
                                              .mesh = shapes::block({60_mm, 30_mm, 60_mm}, {10, 6, 10}),
                                              .material = FemMaterial{.youngModulus = 10_kPa, .poissonRatio = 0.4},
                                              .attachments = {{.box = Box{{-1, -1, -1}, {1, -14.9_mm, 1}}}},
                                              .collision = {{}}});
    sim.show(tissue, {.subdivision = subdivision});
    const auto poseAt = [](double time) {
        return Pose{{0, 20_mm + 8_mm * std::cos(2.0 * std::numbers::pi * time), 0}, {}};
    };
    const BodyId ball =
        addShown(sim, {.name = "ball", .elements = {poseAt(0.0)}, .mesh = shapes::sphere(8_mm)}, kSteel);
    sim.everyStep([&sim, ball, poseAt](double time) { sim.physics().setPose(ball, poseAt(time)); });
}

void addGrasp(Simulation& sim, int subdivision)
{
    const BodyId cube = sim.add(SoftBodyDef{.name = "cube",
                                            .mesh = shapes::block({20_mm, 20_mm, 20_mm}),
                                            .pose = {{0, 10.5_mm, 0}, {}},
                                            .collision = {{}},
                                            .friction = 0.6});
    sim.show(cube, {.subdivision = subdivision});
    addShown(sim, {.name = "table", .elements = {{{0, -5_mm, 0}, {}}}, .mesh = shapes::box({80_mm, 10_mm, 60_mm})},
             kCloth);
    const auto poseAt = [](double side, double time) {
        return Pose{{side * (20_mm - 9.5_mm * swing(time, 0.2, 0.8)), 10_mm + 40_mm * swing(time, 1.0, 1.8), 0}, {}};
    };
    for (const double side : {-1.0, 1.0}) {
        const BodyId jaw = addShown(sim,
                                    {.name = side < 0.0 ? "left jaw" : "right jaw",
                                     .elements = {poseAt(side, 0.0)},
                                     .mesh = shapes::box({4_mm, 12_mm, 16_mm}),
                                     .friction = 0.6},
                                    kSteel);
        sim.everyStep([&sim, jaw, side, poseAt](double time) { sim.physics().setPose(jaw, poseAt(side, time)); });
    }
}

void addFriction(Simulation& sim)
{
    const Quat tilt = axisAngle({0, 0, 1}, -20_deg);
    const auto onSlope = [tilt](Vec3 place) { return Pose{rotate(tilt, place), tilt}; };
    const auto slope = shapes::box({240_mm, 10_mm, 100_mm}), ledge = shapes::box({6_mm, 20_mm, 100_mm});
    addShown(sim, {.name = "slope", .elements = {onSlope({0, -5_mm, 0})}, .mesh = slope, .friction = 0.5}, kCloth);
    addShown(sim, {.name = "ledge", .elements = {onSlope({123_mm, 0, 0})}, .mesh = ledge, .friction = 0.5}, kCloth);
    // The friction of a pair is the geometric mean: 0.4 and 0.3 here, and tan 20 deg = 0.364 lies between them.
    for (const auto& [name, friction, z] : {std::tuple{"rough box", 0.32, -25_mm}, {"smooth box", 0.18, 25_mm}})
        addShown(sim,
                 {.name = name,
                  .elements = {onSlope({-80_mm, 10.1_mm, z})},
                  .mesh = shapes::box({30_mm, 20_mm, 30_mm}),
                  .dynamic = true,
                  .friction = friction},
                 kWood);
}

} // namespace filasofia::app
