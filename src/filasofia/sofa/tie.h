#pragma once

#include "filasofia/sofa/rigid_node.h"
#include "filasofia/sofa/soft_node.h"
#include "filasofia/sofa/tie_rows.h"

#include <span>

namespace filasofia::sofaengine {

/// An attachment that needs constraints: to another body, or one that may break.
class Tie {
public:
    /// One side of it: points of a body, or none for space.
    struct Side {
        SoftNode* soft = nullptr;
        RigidNode* rigid = nullptr;
        int element = 0;                   ///< if it is rigid
        std::vector<TiePoint> points = {}; ///< if it is soft
        std::vector<Vec3> places = {};     ///< [m] if it is rigid: where the points are now
        [[nodiscard]] BodyId id() const { return soft ? soft->id() : rigid ? rigid->id() : BodyId{}; }
    };
    /// What an attachment's Def says besides its points.
    struct Law {
        double stiffness = physics::kHard;        ///< [N/m] a point's; infinite: a weld
        double breakForce = physics::kNever;      ///< [N]
        double pointBreakForce = physics::kNever; ///< [N]
    };

    /// Ties points of a body to as many of another, or to space. `apart`: per pair, how far the first is from the
    /// second, or its place in space [m]. Both bodies are coupled. Throws what SOFA throws.
    Tie(AttachmentId id, const Side& body, const Side& other, const Law& law, std::span<const Vec3> apart,
        ::sofa::simulation::Node& root);
    ~Tie();
    Tie(const Tie&) = delete;
    Tie& operator=(const Tie&) = delete;

    [[nodiscard]] AttachmentId id() const { return report_.id; }
    [[nodiscard]] bool holds(BodyId id) const { return report_.body == id || report_.to == id; }
    [[nodiscard]] bool isBroken() const { return report_.broken; }
    /// After a step: what frames show of it.
    [[nodiscard]] const frame::Attachment& report() const { return report_; }

    void prepare(double dt) { rows_->draw(dt); }
    /// Reads the forces and lets go what they exceed. `impulses`: those by all constraints [N s].
    void finish(std::span<const double> impulses, double dt);

private:
    TieRows::States* statesOf(const Side& side);

    Law law_;
    frame::Attachment report_;
    ::sofa::simulation::Node& root_;
    std::vector<::sofa::simulation::Node::SPtr> nodes_; ///< one for each rigid side
    TieRows::SPtr rows_;
};

} // namespace filasofia::sofaengine
