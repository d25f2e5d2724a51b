#include "filasofia/runtime/surfaces.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/mesh_file.h"

namespace filasofia::runtime {

using geometry::TriangleMesh;

namespace {

constexpr double kCrease = 0.6; ///< [rad], 34 degrees: a box has edges, a sphere of 20 sides has none

} // namespace

std::shared_ptr<const TriangleMesh> loadSurface(const SurfaceSource& source, const std::string& object)
{
    if (const auto* file = std::get_if<std::string>(&source)) {
        if (file->empty()) return nullptr;
        return std::make_shared<const TriangleMesh>(geometry::loadTriangleMesh(*file));
    }
    const auto& given = std::get<std::shared_ptr<const TriangleMesh>>(source);
    if (given) geometry::check(*given, object + ": surface");
    return given;
}

mapping::MappedSurface mapSoft(const physics::SoftBodyDef& body, const TriangleMesh* surface, const std::string& object)
{
    TriangleMesh inWorld = surface ? *surface : TriangleMesh{};
    for (Vec3& vertex : inWorld.vertices) vertex = transform(body.pose, vertex);
    if (physics::isShell(body)) {
        TriangleMesh rest = physics::worldShell(body);
        return surface ? mapping::mapSheet(rest, std::move(inWorld), object) : mapping::mapSheet(std::move(rest));
    }
    const geometry::TetMesh rest = physics::worldMesh(body);
    return surface ? mapping::mapSurface(rest, std::move(inWorld)) : mapping::mapBoundary(rest);
}

std::vector<geometry::Triangle> skinOf(const physics::SoftBodyDef& body, const std::string& object)
{
    mapping::MappedSurface skin = mapSoft(body, nullptr, object);
    const auto& nodes = std::get<mapping::IdentityMap>(skin.map).nodes;
    for (geometry::Triangle& each : skin.surface.triangles)
        for (int& corner : each) corner = nodes[static_cast<std::size_t>(corner)];
    return std::move(skin.surface.triangles);
}

mapping::MappedSurface mapRod(const physics::RodBodyDef& body, const TriangleMesh* surface, const std::string& object)
{
    if (surface) fail(object, ": surface must be empty for a rod, which is drawn as a tube");
    return mapping::mapTube(physics::centreLine(body), body.radius, body.closed);
}

TriangleMesh ownSurface(const physics::RigidBodyDef& body, const ShowDef& def, const std::string& object)
{
    const auto mesh = physics::loadMesh(body.mesh, object);
    if (!mesh) fail(object, ": surface must name a file or be a surface, as the body has no mesh of its own");
    if (def.subdivision > 0)
        return *mesh; // subdivision rounds edges, and would tear a surface that is split along them
    return mapping::withCreases(*mesh, kCrease);
}

visual::Material connectiveTissue()
{
    return visual::TissueMaterial{.baseColor = {0.72, 0.60, 0.48},
                                  .subsurfaceColor = {0.80, 0.45, 0.32},
                                  .roughness = 0.35,
                                  .thickness = 0.1,
                                  .mottling = 0.1,
                                  .vessels = 0.0};
}

visual::Material materialOf(const physics::BodyDef& body)
{
    // No metal: a flat floor of it would mirror nothing but the dark surroundings.
    if (physics::isRigid(body)) return visual::plainMaterial({0.34, 0.35, 0.37});
    if (const auto* rod = std::get_if<physics::RodBodyDef>(&body))
        return visual::ThreadMaterial{.pitch = 5.0 * rod->radius};
    return visual::TissueMaterial{};
}

} // namespace filasofia::runtime
