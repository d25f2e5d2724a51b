#pragma once

#include "filasofia/runtime/follow.h"

#include "filasofia/frame/frame.h"
#include "filasofia/mapping/surface_point.h"
#include "filasofia/visual/transform.h"

namespace filasofia::physics {
class PhysicsServer;
}

namespace filasofia::runtime {

/// Lights, cameras and other Transforms that follow places of bodies. Main thread only.
class Followers {
public:
    /// Detaches the transform from its parent and from what it followed before, and moves it to the body's start.
    /// Throws an Error naming transform and body if the body has no such place.
    void follow(visual::Transform& transform, BodyId id, const FollowDef& def, const physics::PhysicsServer& physics);
    /// The transform stays where it is. Nothing happens if it follows nothing.
    void unfollow(const visual::Transform& transform);
    /// Moves all transforms to the places given by the frame. Forgets transforms that have been destroyed or have got a
    /// parent, and those whose body was removed; they stay where they are.
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
        Quat last = {};    ///< orientation of the surface's frame at the last update
        bool seen = false; ///< the body has been in a frame
    };
    static bool place(Follower& follower, const frame::Frame& frame);

    std::vector<Follower> followers_;
};

} // namespace filasofia::runtime
