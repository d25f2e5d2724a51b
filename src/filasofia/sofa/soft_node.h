#pragma once

#include "filasofia/sofa/body_loads.h"
#include "filasofia/sofa/collision_surface.h"
#include "filasofia/sofa/contact_stage.h"
#include "filasofia/sofa/soft_cuts.h"

#include "filasofia/frame/frame.h"
#include "filasofia/physics/step.h"

#include <sofa/component/statecontainer/MechanicalObject.h>
#include <sofa/simulation/Node.h>

#include <memory>
#include <set>

namespace filasofia::sofaengine {

/// What the solver of a body did in a step.
struct SolveOutcome {
    int iterations = 0;
    double residual = 0.0; ///< [-], relative to the right side
    bool atLimit = false;  ///< it ended at its largest number of iterations
};

/// Where a body is.
struct SoftState {
    std::vector<Vec3> positions = {};  ///< [m]
    std::vector<Vec3> velocities = {}; ///< [m/s]
};

/// What commands change of a soft body, besides its motion.
struct SoftSettings {
    /// Its tissue: the object is another one after each SetMaterial.
    struct Tissue {
        physics::SoftMaterial material = {};
        std::vector<double> youngModulus = {}, poissonRatio = {}, tearing = {}; ///< as in its plan before any edit
    };
    std::shared_ptr<const Tissue> tissue = {};
    std::vector<PinGroup> pins = {};
    std::vector<physics::NodalForce> forces = {};
    double pressure = 0.0; ///< [Pa]
    bool coupled = false;  ///< constraints act on it
    /// Its mesh, if it may be cut
    std::shared_ptr<const CutState> cut = {};
};

/// A soft body in SOFA: a node with its state, mass, law, loads, pins and solvers.
class SoftNode {
public:
    /// Makes the node below `root`; `contact` has been started if the body collides. Throws what SOFA throws.
    SoftNode(BodyId id, SoftPlan plan, ::sofa::simulation::Node& root, const ContactStage& contact);
    ~SoftNode();
    SoftNode(const SoftNode&) = delete;
    SoftNode& operator=(const SoftNode&) = delete;

    [[nodiscard]] BodyId id() const { return id_; }
    [[nodiscard]] const SoftPlan& plan() const { return plan_; } ///< as it was added, but for its material
    [[nodiscard]] ::sofa::simulation::Node& node() const { return *node_; }
    [[nodiscard]] BodyLoads& loads() const { return *loads_; }
    [[nodiscard]] ::sofa::component::statecontainer::MechanicalObject<Vec3Types>& states() const { return *state_; }

    /// Writes the state into lists, whose memory is reused.
    void read(SoftState& out) const;
    void write(const SoftState& state);
    /// Whether every position and velocity is finite and near enough.
    [[nodiscard]] bool isUsable() const;
    [[nodiscard]] SolveOutcome outcome() const;

    [[nodiscard]] double speed() const; ///< [m/s] the fastest node's
    /// The scene has constraints from now on: without it they would hold the body where it is.
    void joinConstraints();
    [[nodiscard]] bool isCoupled() const { return coupled_; }
    /// Whether constraints act on the body from now on: the scene has them. It then has the solver that they need. If
    /// SOFA throws, it is as before.
    void setCoupled(bool coupled);

    [[nodiscard]] SoftSettings settings() const;
    void apply(const SoftSettings& settings);

    /// Its mesh as blades and stress edit it; null if it may not be cut.
    [[nodiscard]] SoftCuts* cuts() const { return cuts_.get(); }
    /// Gives it that mesh, and the tissue of which its plan has the parts.
    void setCuts(std::unique_ptr<SoftCuts> cuts, std::shared_ptr<const SoftSettings::Tissue> tissue);
    /// Per node, 1 if it is pinned hard, or of a piece that was removed.
    [[nodiscard]] const std::vector<char>& held() const { return held_; }
    [[nodiscard]] bool isHeld(const geometry::Tetrahedron& nodes) const; ///< all of them
    /// Whether a user has added components to its node, or nodes below it.
    [[nodiscard]] bool isTuned() const;

    [[nodiscard]] const std::vector<CollisionSurface>& surfaces() const { return surfaces_; }
    /// Attachments to space.
    [[nodiscard]] const std::vector<PinGroup>& pins() const { return pins_; }
    void setPins(std::vector<PinGroup> pins);
    /// Gives it another material of the same mesh; its state stays.
    void setTissue(std::shared_ptr<const SoftSettings::Tissue> tissue);

private:
    using State = ::sofa::component::statecontainer::MechanicalObject<Vec3Types>;

    SoftNode(BodyId id, SoftPlan plan);
    using Component = ::sofa::core::objectmodel::BaseObject::SPtr;
    void add(const Component& component);
    void drop(const Component& component);
    void noteSystems(); ///< those that its solvers have made for themselves
    void addLaw();
    void addSolver();
    void remakeSolver();

    BodyId id_;
    SoftPlan plan_;
    std::shared_ptr<const SoftSettings::Tissue> tissue_;
    std::vector<PinGroup> pins_;
    ::sofa::simulation::Node::SPtr node_;
    State::SPtr state_;
    BodyLoads::SPtr loads_;
    std::vector<CollisionSurface> surfaces_;
    Component law_, fixed_, euler_, solver_, correction_;
    std::set<const ::sofa::core::objectmodel::BaseObject*> own_; ///< the components of its node that are no user's
    bool coupled_ = false;                                       ///< constraints act on it
    std::unique_ptr<SoftCuts> cuts_;
    std::vector<char> held_;
};

} // namespace filasofia::sofaengine
