#include "filasofia/physics/defs.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/mesh_file.h"

namespace filasofia::physics {

std::string describeBody(const BodyDef& def)
{
    if (const auto* soft = std::get_if<SoftBodyDef>(&def)) return text("soft body '", soft->name, "'");
    return text("rigid body '", std::get<RigidBodyDef>(def).name, "'");
}

Pose unitPose(const Pose& pose, std::string_view object)
{
    const Quat q = pose.orientation;
    const double size = std::sqrt(dot(q, q));
    if (!(size > 1e-6)) fail(object, ": orientation must have a length > 1e-06, got ", size);
    const Vec3 p = pose.position;
    if (!(std::abs(p.x) < kFarthest && std::abs(p.y) < kFarthest && std::abs(p.z) < kFarthest))
        fail(object, ": position must lie within ", kFarthest, " m of the origin, got ", p.x, " ", p.y, " ", p.z);
    return {p, normalized(q)};
}

std::shared_ptr<const geometry::TetMesh> loadMesh(const SoftBodyDef& def)
{
    const std::string object = text("soft body '", def.name, "': mesh");
    if (const auto* file = std::get_if<std::string>(&def.mesh)) {
        if (file->empty()) fail(object, " must name a file or be a mesh, got nothing");
        return std::make_shared<const geometry::TetMesh>(geometry::loadTetMesh(*file));
    }
    const auto& given = std::get<std::shared_ptr<const geometry::TetMesh>>(def.mesh);
    if (!given) fail(object, " must name a file or be a mesh, got nothing");
    geometry::check(*given, object);
    return given;
}

geometry::TetMesh worldMesh(const SoftBodyDef& def)
{
    geometry::TetMesh mesh = *loadMesh(def);
    const Pose pose = unitPose(def.pose, text("soft body '", def.name, "': pose"));
    for (Vec3& node : mesh.nodes) node = transform(pose, node);
    return mesh;
}

} // namespace filasofia::physics
