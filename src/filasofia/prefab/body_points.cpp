#include "filasofia/prefab/body_points.h"

namespace filasofia::prefab {

std::optional<Vec3> middleOf(const frame::Frame& frame, BodyId id)
{
    if (const auto* rigid = frame.rigidBody(id)) return rigid->poses.front().position;
    const auto* soft = frame.softBody(id);
    if (!soft || soft->positions.empty()) return {};
    Vec3 sum;
    for (const Vec3& each : soft->positions) sum += each;
    return sum / static_cast<double>(soft->positions.size());
}

std::size_t nodeCount(const physics::BodyDef& def)
{
    if (const auto* rod = std::get_if<physics::RodBodyDef>(&def)) return physics::centreLine(*rod).size();
    const auto& soft = std::get<physics::SoftBodyDef>(def);
    return physics::isShell(soft) ? physics::worldShell(soft).vertices.size() : physics::worldMesh(soft).nodes.size();
}

} // namespace filasofia::prefab
