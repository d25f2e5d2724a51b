#pragma once

#include "filasofia/core/log.h"
#include "filasofia/geometry/shapes.h"

#include "engine/stage.h"

#include <functional>

namespace filasofia::engine {

/// A cube of 2 cm in eight cells with its low corner at (x, 0, 0).
inline physics::SoftBodyDef cube(double x = 0.0)
{
    physics::SoftBodyDef def{.name = "cube", .mesh = shared(boxMesh({2, 2, 2}, {0.02, 0.02, 0.02}))};
    def.pose.position.x = x;
    return def;
}

inline physics::RigidBodyDef rigidBox(Vec3 at, Vec3 half = {0.01, 0.01, 0.01}, bool dynamic = false)
{
    physics::RigidBodyDef def{.name = "box", .elements = {Pose{at, {}}}, .mesh = geometry::shapes::box(2.0 * half)};
    def.dynamic = dynamic;
    return def;
}

/// A stage without gravity, with a soft cube (body 1), the given body (2), and the logged warnings.
struct AttachmentScene {
    Stage stage;
    std::vector<std::string> warnings;

    explicit AttachmentScene(const physics::SoftBodyDef& first = cube())
    {
        setLogSink([this](LogLevel level, std::string_view line) {
            if (level == LogLevel::Warning) warnings.emplace_back(line);
        });
        stage.add(first);
    }
    AttachmentScene(const AttachmentScene&) = delete;
    ~AttachmentScene() { setLogSink({}); }

    AttachmentId attach(const physics::AttachmentDef& def)
    {
        stage.post(physics::Attach{{++stage.lastAttachment}, {1}, def});
        return {stage.lastAttachment};
    }
    AttachmentId attachRigid(BodyId body, const physics::RigidAttachmentDef& def)
    {
        stage.post(physics::AttachRigid{{++stage.lastAttachment}, body, def});
        return {stage.lastAttachment};
    }
    Scene& state() { return stage.world.scene(); }
    /// The nodes of the only attachment.
    std::vector<int> nodes()
    {
        REQUIRE(state().attachments.size() == 1);
        std::vector<int> found;
        for (const auto& pair : state().attachments[0].pairs) found.push_back(pair[0].nodes.at(0).node);
        return found;
    }
    const frame::Attachment* held(AttachmentId id)
    {
        const auto found = std::ranges::find(state().held, id, &frame::Attachment::id);
        return found == state().held.end() ? nullptr : &*found;
    }
};

inline std::vector<int> nodesOfCube(const std::function<bool(Vec3)>& where)
{
    return nodesWhere(boxMesh({2, 2, 2}, {0.02, 0.02, 0.02}), where);
}

} // namespace filasofia::engine
