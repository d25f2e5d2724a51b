#include "filasofia/sofa/moving_blades.h"

#include "filasofia/physics/limits.h"

#include <algorithm>

namespace filasofia::sofaengine {
namespace {

/// A dynamic body moves by forces and never jumps.
bool jumps(const Pose& from, const Pose& to, double dt)
{
    return distance(from.position, to.position) > physics::kTeleport * dt ||
           length(rotationVector(to.orientation * conjugate(from.orientation))) > physics::kTeleportTurn;
}

/// Around what is left of a body.
geometry::Box boxOf(const SoftNode& body, const std::vector<Vec3>& positions)
{
    if (body.plan().gone.empty()) return geometry::boxAround(positions);
    geometry::Box box;
    for (const auto& triangle : body.plan().surface)
        for (const int node : triangle) box = merged(box, positions[static_cast<std::size_t>(node)]);
    return box;
}

} // namespace

std::vector<MovingBlade> moveBlades(const SceneMotion& before, double dt, const SofaScene& scene)
{
    std::vector<MovingBlade> blades;
    for (std::size_t b = 0; b < scene.rigid.size(); ++b) {
        const RigidNode& tool = *scene.rigid[b];
        if (!tool.isCutting()) continue;
        RigidState now;
        tool.read(now);
        for (std::size_t m = 0; m < tool.plan().collision.size(); ++m) {
            const CollisionPlan& model = tool.plan().collision[m];
            if (!model.def.cutting) continue;
            const auto element = static_cast<std::size_t>(model.def.element);
            const Pose &from = before.rigid[b].poses[element], &to = now.poses[element];
            MovingBlade& blade = blades.emplace_back(
                MovingBlade{.body = tool.id(), .group = model.def.group, .lines = tool.plan().lines[m]});
            blade.jumped = !tool.plan().def.dynamic && jumps(from, to, dt);
            for (const Vec3 vertex : model.mesh.vertices) {
                blade.now.push_back(transform(to, vertex));
                blade.before.push_back(transform(blade.jumped ? to : from, vertex));
                blade.swept = merged(merged(blade.swept, blade.now.back()), transform(from, vertex));
            }
        }
    }
    return blades;
}

std::vector<engine::Tool> toolsNear(const SoftNode& body, const std::vector<Vec3>& positions,
                                    const std::vector<MovingBlade>& blades, physics::TopologyReport& report)
{
    std::vector<engine::Tool> tools;
    geometry::Box box;
    for (const MovingBlade& blade : blades) {
        if (!mayBeCut(body.plan().def, blade.group)) continue;
        if (geometry::isEmpty(box)) box = geometry::grown(boxOf(body, positions), body.cuts()->mesh.meanEdge());
        const auto isNear = [&](const std::vector<Vec3>& vertices) {
            return overlap(geometry::boxAround(vertices), box);
        };
        if (blade.jumped && overlap(blade.swept, box)) ++report.bladeTooFast;
        if (!isNear(blade.now) && !isNear(blade.before)) continue;
        if (tools.empty() || tools.back().body != blade.body) tools.push_back({blade.body});
        engine::addBlade(blade.path(), tools.back());
    }
    return tools;
}

} // namespace filasofia::sofaengine
