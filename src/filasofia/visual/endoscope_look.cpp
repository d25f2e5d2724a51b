#include "filasofia/visual/endoscope_look.h"

#include "filasofia/core/error.h"

#include <cmath>
#include <numbers>

namespace filasofia::visual {

geometry::Box boundsOf(const geometry::TriangleMesh& mesh)
{
    if (mesh.vertices.empty()) fail("boundsOf: the mesh has no vertices");
    geometry::Box box;
    for (Vec3 v : mesh.vertices) box = geometry::merged(box, v);
    return box;
}

EndoscopeLook addEndoscopeLook(VisualServer& server, const geometry::Box& around, Quality quality, Vec3 direction)
{
    const double radius = 0.5 * distance(around.low, around.high);
    const Vec3 middle = 0.5 * (around.low + around.high);
    const Vec3 towardsCamera = normalized(direction);
    if (!(radius > 0.0) || !std::isfinite(radius) || !isFinite(middle))
        fail("addEndoscopeLook: the box must be finite and not empty");
    if (towardsCamera == Vec3{} || !isFinite(towardsCamera))
        fail("addEndoscopeLook: direction must be finite and not zero");

    CameraDef cameraDef;
    cameraDef.name = "endoscope camera";
    cameraDef.verticalFieldOfView = 70.0 * std::numbers::pi / 180.0; // wide, as these lenses are
    const double away = 0.80 * radius / std::sin(0.5 * cameraDef.verticalFieldOfView);
    cameraDef.near = 0.05 * away;
    cameraDef.far = 20.0 * away;

    EndoscopeLook look;
    look.rig = &server.addTransform("endoscope");
    look.rig->setPose(lookAt(middle + away * towardsCamera, middle));
    look.camera = &server.add(cameraDef);
    look.camera->attachTo(*look.rig);

    // The lamp sits beside the lens, a little further than on a real tip: its shadows and highlights model the shape.
    SpotLight spot;
    spot.intensity = 8000.0 * away * away; // [cd]: the same illuminance at any distance
    spot.innerAngle = 0.12;
    spot.outerAngle = 0.72;
    spot.range = 8.0 * away;
    LightDef lightDef;
    lightDef.name = "endoscope light";
    lightDef.kind = spot;
    lightDef.color = {1.0, 0.95, 0.88};
    look.light = &server.add(lightDef);
    look.light->attachTo(*look.rig);
    look.light->setPose(lookAt(away * Vec3{-0.16, 0.20, 0.0}, away * Vec3{0.0, 0.02, -1.0}));

    ViewDef view;
    view.name = "endoscope view";
    view.quality = quality;
    view.occlusionRadius = 0.08 * radius;
    look.view = &server.add(view, *look.camera);

    // The walls of the cavity send light back: a dim, soft gleam from above the camera.
    EnvironmentDef environment;
    const Pose rig = look.rig->pose();
    environment.lampDirection = rotate(rig.orientation, Vec3{0.45, 0.8, 0.6});
    server.setEnvironment(environment);
    return look;
}

} // namespace filasofia::visual
