#include "filasofia/runtime/surfaces.h"

#include "filasofia/geometry/mesh_file.h"

namespace filasofia::runtime {

using geometry::TriangleMesh;

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

mapping::MappedSurface mapSoft(const physics::SoftBodyDef& body, const TriangleMesh* surface)
{
    const geometry::TetMesh rest = physics::worldMesh(body);
    if (!surface) return mapping::mapBoundary(rest);
    TriangleMesh inWorld = *surface;
    for (Vec3& vertex : inWorld.vertices) vertex = transform(body.pose, vertex);
    return mapping::mapSurface(rest, std::move(inWorld));
}

} // namespace filasofia::runtime
