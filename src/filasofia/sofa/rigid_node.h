#pragma once

#include "filasofia/sofa/contact_stage.h"
#include "filasofia/sofa/rigid_plan.h"
#include "filasofia/sofa/sofa_vec.h"

#include "filasofia/frame/frame.h"

#include <sofa/component/statecontainer/MechanicalObject.h>
#include <sofa/core/behavior/ForceField.h>
#include <sofa/simulation/Node.h>

#include <optional>

namespace filasofia::sofaengine {

/// The wrenches that commands put on the elements of a dynamic body, and the opposite of gravity if it has none.
class RigidLoads final : public ::sofa::core::behavior::ForceField<RigidTypes> {
public:
    SOFA_CLASS(RigidLoads, SOFA_TEMPLATE(::sofa::core::behavior::ForceField, RigidTypes));

    /// On an element, at its centre of mass.
    struct Wrench {
        Vec3 force = {};  ///< [N]
        Vec3 torque = {}; ///< [N m]
    };
    std::vector<Wrench> wrenches = {}; ///< one per element
    double weightless = 0.0;           ///< [kg] per element, if gravity does not act on the body; else 0

    void addForce(const ::sofa::core::MechanicalParams* params, DataVecDeriv& f, const DataVecCoord& x,
                  const DataVecDeriv& v) override;
    void addDForce(const ::sofa::core::MechanicalParams* /*params*/, DataVecDeriv& /*df*/,
                   const DataVecDeriv& /*dx*/) override
    {
    }
    void buildStiffnessMatrix(::sofa::core::behavior::StiffnessMatrix* /*matrix*/) override {}
    void buildDampingMatrix(::sofa::core::behavior::DampingMatrix* /*matrix*/) override {}
    SReal getPotentialEnergy(const ::sofa::core::MechanicalParams* /*params*/, const DataVecCoord& /*x*/) const override
    {
        return 0.0; // nobody asks
    }
    using ForceField::addDForce;
    using ForceField::addForce;
    using ForceField::getPotentialEnergy;
};

/// Where a rigid body is, per element.
struct RigidState {
    std::vector<Pose> poses = {};             ///< where the elements have their origins
    std::vector<Vec3> velocities = {};        ///< [m/s] at the centres of mass
    std::vector<Vec3> angularVelocities = {}; ///< [rad/s] in world axes
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

    void read(RigidState& out) const;
    void write(const RigidState& state);
    [[nodiscard]] RigidState start() const; ///< as the Def says
    [[nodiscard]] bool isUsable() const;

    [[nodiscard]] double speed() const; ///< [m/s] of the fastest point of its collision models, and of its centres
    /// The scene has constraints from now on: without it they would hold the body where it is.
    void joinConstraints();

    void setWrench(int element, const RigidLoads::Wrench& wrench);
    /// For a dynamic body its pose at once and at rest, for a kinematic one that at the end of the next step.
    void setPose(int element, const Pose& pose);
    /// Gives a kinematic body the velocities that lead to its poses in dt [s]; finishMove() puts it there.
    void beginMove(double dt);
    void finishMove();

private:
    RigidNode(BodyId id, RigidPlan plan) : id_(id), plan_(std::move(plan)), targets_(plan_.def.elements.size()) {}

    using State = ::sofa::component::statecontainer::MechanicalObject<RigidTypes>;

    BodyId id_;
    RigidPlan plan_;
    ::sofa::simulation::Node::SPtr node_;
    State::SPtr state_;
    RigidLoads::SPtr loads_; ///< null for a kinematic body
    bool constrained_ = false;
    double reach_ = 0.0;                       ///< [m] of its collision models, from the centre of mass
    std::vector<std::optional<Pose>> targets_; ///< where a kinematic body will be at the end of the step
};

} // namespace filasofia::sofaengine
