#pragma once

#include "filasofia/runtime/follow.h"

#include "filasofia/frame/frame.h"
#include "filasofia/mapping/surface_point.h"
#include "filasofia/visual/transform.h"

namespace filasofia::physics {
class PhysicsServer;
}

namespace filasofia::runtime {

/// Lights, cameras and whatever else is a Transform, on places of bodies. Main thread only.
class Followers {
public:
    /// The transform leaves its parent and whatever it followed before, and is where the body starts. Throws an Error
    /// naming transform and body when the body has no such place.
    void follow(visual::Transform& transform, BodyId id, const FollowDef& def, const physics::PhysicsServer& physics);
    /// It stays where it is. Nothing happens where it follows nothing.
    void unfollow(const visual::Transform& transform);
    /// Moves all to where the frame says. Forgets transforms that have ended or have got a parent, and those of bodies
    /// that are gone: they stay where they are.
    void update(const frame::Frame& frame, const physics::PhysicsServer& physics);
    void clear() { followers_.clear(); }
    [[nodiscard]] int count() const { return static_cast<int>(followers_.size()); }

private:
    struct Follower {
        visual::Transform* transform = nullptr;
        std::weak_ptr<const void> life = {};
        BodyId id = {};
        std::variant<mapping::RigidMap, mapping::SurfacePoint> map = {};
        Pose offset = {};
        Quat last = {};    ///< of the surface's frame
        bool seen = false; ///< the body has been in a frame
    };
    static bool place(Follower& follower, const frame::Frame& frame);

    std::vector<Follower> followers_;
};

} // namespace filasofia::runtime
