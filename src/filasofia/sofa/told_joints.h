#pragma once

#include "filasofia/frame/joint.h"
#include "filasofia/physics/defs.h"

#include <span>
#include <vector>

namespace filasofia::sofaengine {

/// A force of a contact or an attachment on an element of a rigid body.
struct PointForce {
    BodyId body = {};
    int element = 0;
    Vec3 point = {}; ///< [m]
    Vec3 force = {}; ///< [N]
};

/// The joints of a told body: each goes to its commanded position at its speed, whatever is in its way, and moves its
/// links.
class ToldJoints {
public:
    struct State {
        std::vector<double> targets = {};      ///< [rad] or [m] per joint
        std::vector<frame::Joint> joints = {}; ///< with their positions now
    };
    explicit ToldJoints(const physics::RigidBodyDef& def);

    [[nodiscard]] bool empty() const { return state_.joints.empty(); }
    void setTarget(int joint, double position);
    /// Moves the joints by a step of dt [s]. Returns the poses of all elements if the base is at `base`.
    std::vector<Pose> move(double dt, const Pose& base);
    /// What forces on the body's elements do to each joint. `poses`: where the elements are.
    void load(std::span<const PointForce> forces, std::span<const Pose> poses);
    void rewind(); ///< as the Def says

    [[nodiscard]] const State& state() const { return state_; }
    void apply(const State& state) { state_ = state; }

private:
    [[nodiscard]] bool moves(std::size_t joint, int element) const;

    physics::RigidBodyDef def_; ///< its starts are the present positions
    std::vector<double> starts_;
    State state_;
};

} // namespace filasofia::sofaengine
