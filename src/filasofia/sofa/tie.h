#pragma once

#include "filasofia/core/hash.h"
#include "filasofia/sofa/rigid_node.h"
#include "filasofia/sofa/soft_node.h"
#include "filasofia/sofa/tie_rows.h"

#include <functional>
#include <span>

namespace filasofia::sofaengine {

/// A side of a tie: a body, or none for space.
struct TieEnd {
    BodyId id = {};
    int element = 0;               ///< if it is rigid
    std::vector<Vec3> points = {}; ///< [m] if it is rigid: from the element's centre of mass, in its axes
};
/// What an attachment's Def says besides its points.
struct TieLaw {
    double stiffness = physics::kHard;        ///< [N/m] a point's; infinite: a weld
    double breakForce = physics::kNever;      ///< [N]
    double pointBreakForce = physics::kNever; ///< [N]
    double cutDistance = 0.0;                 ///< [m] a blade that comes so near parts a point; 0: none does
};
/// A whole tie, as plain data.
struct TieState {
    TieEnd body = {}, to = {};
    TieLaw law = {};
    bool grasp = false;                    ///< made by a Grasp
    std::vector<TieRows::Pair> pairs = {}; ///< those that hold
    std::vector<TieRows::Pair> whole = {}; ///< those that it was made with
    frame::Attachment report = {};         ///< with its id
};
void addTo(Hasher& hash, const TieState& tie);

/// An attachment that needs constraints: to another body, or one that may break.
class Tie {
public:
    struct Side {
        SoftNode* soft = nullptr;
        RigidNode* rigid = nullptr; ///< both are null for space
    };

    /// Both bodies are coupled. Throws what SOFA throws.
    Tie(TieState state, const Side& body, const Side& to, ::sofa::simulation::Node& root);
    ~Tie();
    Tie(const Tie&) = delete;
    Tie& operator=(const Tie&) = delete;

    [[nodiscard]] AttachmentId id() const { return state_.report.id; }
    [[nodiscard]] bool holds(BodyId id) const { return state_.body.id == id || state_.to.id == id; }
    [[nodiscard]] bool grasps() const { return state_.grasp; }
    [[nodiscard]] bool isBroken() const { return state_.report.broken; }
    /// After a step: what frames show of it.
    [[nodiscard]] const frame::Attachment& report() const { return state_.report; }
    [[nodiscard]] TieState state() const;

    /// Where its points are on the body [m].
    [[nodiscard]] std::vector<Vec3> places() const;
    void prepare(double dt) { rows_->draw(dt); }
    /// Reads the forces and lets go what they exceed. `impulses`: those by all constraints [N s].
    void finish(std::span<const double> impulses, double dt);
    /// Lets go the points of the body that blades have parted. `parts` is asked with each point's place.
    void cut(const std::function<bool(Vec3)>& parts);
    [[nodiscard]] const TieLaw& law() const { return state_.law; }
    [[nodiscard]] BodyId body() const { return state_.body.id; }
    [[nodiscard]] BodyId to() const { return state_.to.id; }
    /// Adds the forces on its sides.
    void addForces(std::vector<PointForce>& out) const;
    /// Begins anew where its bodies are now: all of its points hold, and welds are drawn together from there.
    void rewind();

private:
    Tie(TieState state, const std::array<Side, 2>& sides, ::sofa::simulation::Node& root);
    TieRows::States* statesOf(std::size_t side);
    [[nodiscard]] const TieEnd& end(std::size_t side) const { return side == 0 ? state_.body : state_.to; }
    [[nodiscard]] Vec3 placeOf(std::size_t side, const TiePoint& point) const;

    TieState state_; ///< its pairs are those of the rows
    std::array<Side, 2> sides_;
    ::sofa::simulation::Node& root_;
    std::vector<::sofa::simulation::Node::SPtr> nodes_; ///< one for each rigid side
    TieRows::SPtr rows_;
};

/// [m] in the world: points of an element, given from its centre of mass in its axes.
Vec3 worldPoint(const RigidNode& body, int element, Vec3 point);

} // namespace filasofia::sofaengine
