#pragma once

#include "filasofia/geometry/shapes.h"

#include "verification/verification.h"

/// Bodies to attach to each other, and functions that measure attachments.
namespace filasofia::engine {

inline constexpr double kG = 9.81;
inline constexpr geometry::Box kLeft{{-1, -1, -1}, {1e-6, 1, 1}};

/// A beam from the origin along x.
inline physics::SoftBodyDef beam(std::array<int, 3> cells, Vec3 size, double x = 0.0)
{
    physics::SoftBodyDef def{.name = "beam", .mesh = shared(boxMesh(cells, size))};
    def.pose.position.x = x;
    def.material = physics::FemMaterial{.youngModulus = 5e4, .poissonRatio = 0.3};
    return def;
}

inline physics::RigidBodyDef rigidBox(const std::string& name, Vec3 half, Vec3 at, bool dynamic = true)
{
    physics::RigidBodyDef def{.name = name, .elements = {Pose{at, {}}}, .mesh = geometry::shapes::box(2.0 * half)};
    def.dynamic = dynamic;
    return def;
}

inline double weightOf(const Stage& stage, std::size_t body)
{
    double mass = 0.0;
    for (double each : const_cast<Stage&>(stage).model(body).masses) mass += each;
    return mass * kG;
}

inline const frame::Attachment& attachmentOf(Stage& stage, AttachmentId id)
{
    const auto found = std::ranges::find(stage.world.scene().held, id, &frame::Attachment::id);
    REQUIRE(found != stage.world.scene().held.end());
    return *found;
}

inline Vec3 placeOf(Stage& stage, const AttachedPoint& point, BodyId id)
{
    const Scene& scene = stage.world.scene();
    for (std::size_t b = 0; b < scene.soft.size(); ++b) {
        if (scene.soft[b].model.id != id) continue;
        Vec3 sum;
        for (const NodeWeight& each : point.nodes)
            sum += each.weight * stage.soft(b).x[static_cast<std::size_t>(each.node)];
        return sum;
    }
    for (std::size_t b = 0; b < scene.rigid.size(); ++b)
        if (scene.rigid[b].model.id == id)
            return transform(stage.world.scene().rigid[b].state.poses[static_cast<std::size_t>(point.element)],
                             point.place);
    return point.place;
}

/// [m] The largest distance between two points that should coincide.
inline double worstGap(Stage& stage)
{
    double worst = 0.0;
    for (const Attachment& each : stage.world.scene().attachments)
        for (const auto& pair : each.pairs)
            worst = std::max(worst, distance(placeOf(stage, pair[0], each.body), placeOf(stage, pair[1], each.to)));
    return worst;
}

/// [N], [N m] about the origin: the wrench that an attachment exerts on its body.
inline Wrench wrenchOf(Stage& stage, AttachmentId id)
{
    const Scene& scene = stage.world.scene();
    Wrench sum;
    for (std::size_t a = 0; a < scene.attachments.size(); ++a) {
        if (scene.attachments[a].id != id) continue;
        for (std::size_t p = 0; p < scene.attachments[a].pairs.size(); ++p) {
            const Vec3 force = scene.holding[a][p];
            sum.force += force;
            sum.torque += cross(placeOf(stage, scene.attachments[a].pairs[p][0], scene.attachments[a].body), force);
        }
    }
    return sum;
}

inline Stage withGravity()
{
    Stage stage;
    stage.post(physics::SetGravity{{0, -kG, 0}});
    return stage;
}

} // namespace filasofia::engine
