#pragma once

#include "filasofia/sofa/rigid_loads.h"
#include "filasofia/sofa/rigid_state.h"

#include "filasofia/engine/articulation/joint_plan.h"
#include "filasofia/frame/joint.h"

#include <span>
#include <utility>
#include <vector>

namespace filasofia::sofaengine {

/// The joints of a rigid body and what they do to its elements, its links: the same equations as in the native engine
/// (engine/articulation). A joint that is told a position goes there whatever is in its way. A joint that a force
/// drives, and the base of a dynamic body, are free: SOFA's constraint solver changes their velocities by way of
/// respond() and push(). SOFA itself sees the links as elements whose velocities are given.
class Articulation {
public:
    struct State {
        std::vector<physics::JointCommand> commands = {};
        std::vector<frame::Joint> joints = {}; ///< with their positions now
    };
    explicit Articulation(const physics::RigidBodyDef& def);

    [[nodiscard]] bool empty() const { return tree_.joints.empty(); }
    /// Whether forces move some of it: a joint that a force drives, or its base.
    [[nodiscard]] bool isDriven() const;
    [[nodiscard]] int parentOf(int element) const; ///< the link that a joint connects a link to; -1: none
    void setCommand(int joint, const physics::JointCommand& command);
    std::vector<engine::Wrench> wrenches = {}; ///< one per link

    /// Begins a step of dt [s]. `now` comes with the last step's velocities and gets those of this one, without
    /// constraints. `base`: where a base that is told will be.
    void begin(double dt, const Pose& base, Vec3 gravity, RigidState& now);
    /// A link, and an impulse on it or a change of its motion.
    using Part = std::pair<int, RigidTypes::Deriv>;
    /// How impulses on links change the motion of all links.
    [[nodiscard]] std::vector<Part> respond(std::span<const Part> impulses) const;
    /// The same, as what constraints do in this step.
    std::vector<Part> push(std::span<const Part> impulses);
    /// Ends the step: moves the joints and the links. False if that gives no usable numbers: only the base has moved,
    /// and the joints rest. `failed`: SOFA has not made the step.
    bool finish(double dt, bool failed, RigidState& now);

    /// A limit or the friction of a free joint, as a constraint of this step.
    struct Row {
        int joint = 0;
        double arm = 1.0;             ///< [m] a link's way per rad, or 1
        double sign = 1.0;            ///< the sense of its way: -1 for an upper limit
        double gap = 0.0;             ///< [m] at the end of the step, without constraints
        double low = 0.0, high = 0.0; ///< [N s] bounds of its impulse
        bool limit = true;
    };
    [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
    /// An impulse on the links by one on a row.
    [[nodiscard]] std::vector<Part> partsOf(const Row& row) const;

    /// After a step: what forces on links, and impulses of rows [N s], do to the joints.
    void load(std::span<const PointForce> forces, std::span<const double> impulses, double dt);
    void rewind(); ///< as the Def says

    [[nodiscard]] const State& state() const { return state_; }
    void apply(const State& state) { state_ = state; }
    /// Places the links by the joints; the base is where it is.
    void place(std::vector<Pose>& poses) const;
    void rest(); ///< stops the joints

private:
    [[nodiscard]] std::vector<engine::DrivenJoint> joints() const;
    void addRows(double dt);
    [[nodiscard]] std::vector<double> changeBy(std::span<const Part> impulses) const;
    [[nodiscard]] std::vector<Part> changes(std::span<const double> change) const;

    engine::LinkTree tree_;
    std::vector<physics::JointCommand> starts_;
    std::vector<physics::RigidInertia> inertias_;
    bool dynamic_ = false, gravity_ = true;
    double linearDamping_ = 0.0, angularDamping_ = 0.0;
    State state_;

    // The step, as it was planned.
    bool begun_ = false;
    engine::JointPlan plan_;
    std::vector<Pose> poses_;    ///< at its start
    Pose baseEnd_;               ///< where a base that is told will be
    std::vector<char> moves_;    ///< per link: a free joint moves it
    std::vector<double> pushed_; ///< change of the free joints' velocities by constraints
    std::vector<Row> rows_;
};

} // namespace filasofia::sofaengine
