#include "filasofia/visual/endoscope_look.h"

#include "filasofia/core/error.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace filasofia::visual {
namespace {

constexpr double kFieldOfView = 70.0 * std::numbers::pi / 180.0; ///< [rad], wide, as these lenses are

/// `away` [m] is the distance from the lens to the middle of the scene, here and below.
Camera& addCamera(VisualServer& server, Transform& rig, double away)
{
    CameraDef def;
    def.name = "endoscope camera";
    def.verticalFieldOfView = kFieldOfView;
    def.near = 0.05 * away;
    def.far = 20.0 * away;
    Camera& camera = server.add(def);
    camera.attachTo(rig);
    return camera;
}

/// The light is beside the lens, a little further than on a real tip, so that shadows and highlights show the shape.
Light& addLamp(VisualServer& server, Transform& rig, double away)
{
    SpotLight spot;
    // Filament takes what is nearer than this to be so far away; and what is seen is nearer than the middle.
    constexpr double kNearest = 0.01, kSeen = 0.85; // [m], [-]
    const double lit = std::max(away, kNearest / kSeen);
    spot.intensity = 8000.0 * lit * lit; // [cd], the same illuminance at any distance
    spot.innerAngle = 0.45;
    spot.outerAngle = 0.95; // slightly beyond the corners of the picture, so that none of it is black
    spot.range = 8.0 * away;
    LightDef def;
    def.name = "endoscope light";
    def.kind = spot;
    def.color = {1.0, 0.95, 0.88};
    Light& light = server.add(def);
    light.attachTo(rig);
    light.setPose(lookAt(away * Vec3{-0.16, 0.20, 0.0}, away * Vec3{0.0, 0.02, -1.0}));
    return light;
}

/// From where the look sees a box.
struct Aim {
    double radius = 0.0, away = 0.0; ///< [m]: the box's, and from its middle to the lens
    Pose pose = {};
};
Aim aimed(const geometry::Box& around, Vec3 direction, const char* who)
{
    const double radius = 0.5 * distance(around.low, around.high);
    const Vec3 middle = 0.5 * (around.low + around.high);
    const Vec3 towardsCamera = normalized(direction);
    if (!(radius > 0.0) || !std::isfinite(radius) || !isFinite(middle))
        fail(who, ": the box must be finite and not empty");
    if (towardsCamera == Vec3{} || !isFinite(towardsCamera)) fail(who, ": direction must be finite and not zero");
    const double away = 0.80 * radius / std::sin(0.5 * kFieldOfView); // corners of a box that an organ fills are empty
    return {radius, away, lookAt(middle + away * towardsCamera, middle)};
}

} // namespace

geometry::Box boundsOf(const geometry::TriangleMesh& mesh)
{
    if (mesh.vertices.empty()) fail("boundsOf: the mesh has no vertices");
    geometry::Box box;
    for (Vec3 v : mesh.vertices) box = geometry::merged(box, v);
    return box;
}

EndoscopeLook addEndoscopeLook(VisualServer& server, const geometry::Box& around, Quality quality, Vec3 direction)
{
    const auto [radius, away, pose] = aimed(around, direction, "addEndoscopeLook");

    EndoscopeLook look;
    look.rig = &server.addTransform("endoscope");
    look.rig->setPose(pose);
    look.camera = &addCamera(server, *look.rig, away);
    look.light = &addLamp(server, *look.rig, away);

    ViewDef view;
    view.name = "endoscope view";
    view.quality = quality;
    view.occlusionRadius = 0.08 * radius;
    look.view = &server.add(view, *look.camera);

    // What is around reflects light: a soft glow from above the camera. Without it, all that faces aside is nearly
    // black.
    EnvironmentDef environment;
    environment.intensity = 600.0;
    environment.above = {0.55, 0.475, 0.465};
    environment.below = {0.25, 0.2, 0.195};
    environment.lampDirection = rotate(look.rig->pose().orientation, Vec3{0.45, 0.8, 0.6});
    server.setEnvironment(environment);
    return look;
}

geometry::Box framing(const geometry::Box& around, std::span<const Vec3> points, double aspect, Vec3 direction)
{
    constexpr double kRim = 0.96; // [-] relative to height and width
    const Aim aim = aimed(around, direction, "framing");
    if (!(aspect > 0.0) || !std::isfinite(aspect)) fail("framing: aspect must be > 0 and finite, got ", aspect);
    const double up = kRim * std::tan(0.5 * kFieldOfView), right = aspect * up;
    const Pose fromWorld = inverse(aim.pose);
    double needed = aim.away; // [m]
    for (const Vec3 each : points) {
        const Vec3 seen = transform(fromWorld, each); // the lens looks along -z
        needed = std::max(needed, aim.away + seen.z + std::max(std::fabs(seen.y) / up, std::fabs(seen.x) / right));
    }
    const Vec3 middle = 0.5 * (around.low + around.high), half = 0.5 * needed / aim.away * (around.high - around.low);
    return needed > aim.away ? geometry::Box{middle - half, middle + half} : around;
}

} // namespace filasofia::visual
