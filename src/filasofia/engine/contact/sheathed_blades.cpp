#include "filasofia/engine/contact/sheathed_blades.h"

#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/rupture/elements_at.h"

#include <vector>

namespace filasofia::engine {
namespace {

/// The world's places of a blade's triangles, three by three.
std::vector<Vec3> bladeCorners(const RigidBody& body, const CollisionModel& blade)
{
    std::vector<Vec3> corners;
    const Pose& pose = body.state.poses[static_cast<std::size_t>(blade.element)];
    for (const geometry::Triangle& triangle : blade.shape->triangles)
        for (const int vertex : triangle)
            corners.push_back(transform(pose, blade.shape->rest[static_cast<std::size_t>(vertex)]));
    return corners;
}

ElementsAtBlade elementsOf(const SoftBody& body, const std::vector<Vec3>& corners)
{
    return elementsAt(corners,
                      {.count = elementCount(body.model),
                       .nodes = [&](std::size_t e) { return elementNodes(body.model, e); },
                       .isLeftOut = [&](std::size_t e) { return allHeld(body.model, e); }},
                      body.state.x);
}

} // namespace

ElementsAtBlade elementsAtBlades(const Scene& scene, const RigidBody& body)
{
    ElementsAtBlade count;
    for (const CollisionModel& each : body.model.collision) {
        if (!each.shape->cutting) continue;
        const std::vector<Vec3> corners = bladeCorners(body, each);
        for (const SoftBody& soft : scene.soft)
            if (!isRod(soft.model) && mayBeCut(soft.model, each.shape->group)) count += elementsOf(soft, corners);
    }
    return count;
}

void followSheaths(Scene& scene, physics::TopologyReport& report)
{
    for (RigidBody& body : scene.rigid) {
        if (body.state.sheath == 0) continue;
        const ElementsAtBlade now = elementsAtBlades(scene, body);
        if (now.near == 0) body.state.sheath = 0;
        if (isPushedOn(now, body.state.sheath)) ++report.bladeOff;
    }
}

} // namespace filasofia::engine
