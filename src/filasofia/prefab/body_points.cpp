#include "filasofia/prefab/body_points.h"

#include "filasofia/core/error.h"

namespace filasofia::prefab {
namespace {

/// How many nodes a soft body or a rod has before it is cut.
std::size_t nodeCount(const physics::BodyDef& def)
{
    if (const auto* rod = std::get_if<physics::RodBodyDef>(&def)) return physics::centreLine(*rod).size();
    const auto& soft = std::get<physics::SoftBodyDef>(def);
    return physics::isShell(soft) ? physics::worldShell(soft).vertices.size() : physics::worldMesh(soft).nodes.size();
}

} // namespace

std::optional<Vec3> middleOf(const frame::Frame& frame, BodyId id)
{
    if (const auto* rigid = frame.rigidBody(id)) return rigid->poses.front().position;
    const auto* soft = frame.softBody(id);
    if (!soft || soft->positions.empty()) return {};
    Vec3 sum;
    for (const Vec3& each : soft->positions) sum += each;
    return sum / static_cast<double>(soft->positions.size());
}

std::optional<Vec3> pointOf(const frame::Frame& frame, BodyId id, int element, Vec3 tip, const std::optional<int>& node)
{
    const auto at = static_cast<std::size_t>(element);
    if (const auto* rigid = frame.rigidBody(id))
        return at < rigid->poses.size() ? std::optional(transform(rigid->poses[at], tip)) : std::nullopt;
    const auto* soft = frame.softBody(id);
    return node && soft ? std::optional(soft->positions[static_cast<std::size_t>(*node)]) : middleOf(frame, id);
}

void checkBodyPoint(const physics::BodyDef& def, int element, const std::optional<int>& node, const std::string& path)
{
    const auto* rigid = std::get_if<physics::RigidBodyDef>(&def);
    const std::size_t elements = rigid ? physics::elementCount(*rigid) : 1;
    if (element < 0 || static_cast<std::size_t>(element) >= elements)
        fail(path, "element must be in [0, ", elements, "), got ", element);
    if (!node) return;
    if (rigid)
        fail(path, "node must not be given for a rigid body, which has elements; got ", physics::describeBody(def));
    const std::size_t nodes = nodeCount(def);
    if (*node < 0 || static_cast<std::size_t>(*node) >= nodes)
        fail(path, "node must be in [0, ", nodes, "), got ", *node);
}

} // namespace filasofia::prefab
