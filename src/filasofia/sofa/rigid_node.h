#pragma once

#include "filasofia/sofa/articulation.h"
#include "filasofia/sofa/collision_surface.h"
#include "filasofia/sofa/contact_stage.h"
#include "filasofia/sofa/element_mass.h"
#include "filasofia/sofa/joint_rows.h"
#include "filasofia/sofa/rigid_loads.h"
#include "filasofia/sofa/rigid_plan.h"
#include "filasofia/sofa/rigid_state.h"

#include "filasofia/frame/frame.h"

#include <sofa/component/statecontainer/MechanicalObject.h>
#include <sofa/simulation/Node.h>

#include <optional>

namespace filasofia::sofaengine {

/// What commands change of a rigid body, besides its motion; per element.
struct RigidSettings {
    std::vector<engine::Wrench> wrenches = {};               ///< empty if it is kinematic without joints
    std::vector<std::optional<RigidLoads::Hand>> hands = {}; ///< empty if it is kinematic
    std::vector<std::optional<Pose>> targets = {}; ///< where a kinematic body will be at the end of the next step
    Articulation::State joints = {};
    bool cutting = true; ///< its blades cut
    int sheath = 0;      ///< [-] more than 0 for blades that were switched off inside tissue (elements_at.h)
};

/// A rigid body in SOFA: a node with one frame per element at its centre of mass. A kinematic body has no solver.
class RigidNode {
public:
    /// Makes the node below `root`; `contact` has been started if the body collides. Throws what SOFA throws.
    RigidNode(BodyId id, RigidPlan plan, ::sofa::simulation::Node& root, const ContactStage& contact);
    ~RigidNode();
    RigidNode(const RigidNode&) = delete;
    RigidNode& operator=(const RigidNode&) = delete;

    [[nodiscard]] BodyId id() const { return id_; }
    [[nodiscard]] const RigidPlan& plan() const { return plan_; }
    [[nodiscard]] ::sofa::simulation::Node& node() const { return *node_; }

    [[nodiscard]] ::sofa::component::statecontainer::MechanicalObject<RigidTypes>& states() const { return *state_; }

    void read(RigidState& out) const;
    void write(const RigidState& state);
    [[nodiscard]] RigidState start() const; ///< as the Def says
    [[nodiscard]] bool isUsable() const;

    [[nodiscard]] const std::vector<CollisionSurface>& surfaces() const { return surfaces_; }
    [[nodiscard]] double speed() const; ///< [m/s] the fastest point of its collision models, and of its centres
    /// The scene has constraints from now on: without it they would hold the body where it is.
    void joinConstraints();

    void setWrench(int element, const engine::Wrench& wrench);
    /// A hand that holds an element of a dynamic body from now on; without stiffness and damping none.
    void setHand(int element, const physics::HapticTarget& target);
    /// For a dynamic body its pose at once and at rest, for a kinematic one that at the end of the next step.
    void setPose(int element, const Pose& pose);
    void setJoint(int joint, const physics::JointCommand& command) { joints_.setCommand(joint, command); }
    /// Gives what SOFA does not solve for its velocities in dt [s]: a kinematic body those that lead to its poses,
    /// links those that their joints have without constraints. `carrier`: the body that a base follows, which has
    /// begun; or null.
    void beginMove(double dt, const RigidNode* carrier);
    /// Puts it where that leads. `failed`: SOFA has not made the step. False if joints cannot be moved so.
    bool finishMove(double dt, bool failed);
    /// Whether its blades cut, and how many elements they were in when they were switched off. They pass through what
    /// they could cut in both cases.
    void setBlades(bool cutting, int sheath);
    [[nodiscard]] bool isCutting() const { return cutting_; }
    [[nodiscard]] int sheath() const { return sheath_; }
    /// After a step: what forces on the body and constraints, whose impulses [N s] these are, do to its joints.
    void loadJoints(std::span<const PointForce> forces, std::span<const double> impulses, double dt);
    [[nodiscard]] const std::vector<frame::Joint>& joints() const { return joints_.state().joints; }
    /// Puts it where its Def says.
    void rewind();

    [[nodiscard]] RigidSettings settings() const;
    void apply(const RigidSettings& settings);

private:
    RigidNode(BodyId id, RigidPlan plan)
        : id_(id), plan_(std::move(plan)), joints_(plan_.def), targets_(plan_.def.elements.size())
    {
    }
    [[nodiscard]] Pose endOf(int element) const; ///< where it will be at the end of the step
    void beginJoints(double dt, const RigidNode* carrier);
    void addSolved(); ///< what a body needs that SOFA solves
    [[nodiscard]] bool isSolved() const { return plan_.def.dynamic && joints_.empty(); } ///< by SOFA

    using State = ::sofa::component::statecontainer::MechanicalObject<RigidTypes>;

    BodyId id_;
    RigidPlan plan_;
    Articulation joints_;
    ::sofa::simulation::Node::SPtr node_;
    State::SPtr state_;
    RigidLoads::SPtr loads_; ///< null unless SOFA solves it
    ElementMass::SPtr mass_; ///< null unless SOFA solves it
    JointRows::SPtr rows_;   ///< null without joints
    std::vector<CollisionSurface> surfaces_;
    std::shared_ptr<bool> driven_ = std::make_shared<bool>(false); ///< forces move some of its links
    bool constrained_ = false;
    bool cutting_ = true;
    int sheath_ = 0;
    std::shared_ptr<bool> passes_ = std::make_shared<bool>(true); ///< its blades, through what they could cut
    double reach_ = 0.0;                       ///< [m] from the centre of mass to the farthest vertex of its models
    std::vector<std::optional<Pose>> targets_; ///< where a kinematic body will be at the end of the step
};

} // namespace filasofia::sofaengine
