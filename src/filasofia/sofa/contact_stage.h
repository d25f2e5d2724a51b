#pragma once

#include "filasofia/sofa/collision_plan.h"

#include "filasofia/physics/step.h"
#include "filasofia/sofa/contact_response.h"

#include <sofa/simulation/Node.h>

#include <atomic>
#include <memory>

namespace filasofia::sofaengine {

/// Contact in a graph: SOFA's collision pipeline below its root and, for exact contact, an animation loop that solves
/// for the forces. Nothing of it is there until a body collides.
class ContactStage {
public:
    /// Throws an Error if this engine lacks what the method asks for.
    explicit ContactStage(const physics::ContactMethod& method);
    ~ContactStage();
    ContactStage(const ContactStage&) = delete;
    ContactStage& operator=(const ContactStage&) = delete;

    [[nodiscard]] const physics::ContactMethod& method() const { return method_; }
    [[nodiscard]] bool isOn() const { return parts_ != nullptr; }
    /// Whether forces are found by constraints: then every body needs a correction.
    [[nodiscard]] bool isExact() const { return std::holds_alternative<physics::ExactContact>(method_); }
    [[nodiscard]] bool constrains() const { return isOn() && isExact(); }
    /// [N/m] that each contact has by penalty; else 0.
    [[nodiscard]] double stiffness() const;
    /// [m] At this distance a surface of this proximity begins to push.
    [[nodiscard]] double skin(double proximity) const;

    /// Throws an Error if a body cannot meet others by this method. Warns once if its friction will have no effect.
    /// From any thread.
    void check(const physics::BodyDef& def) const;
    /// Throws an Error that begins with `object` if bodies cannot be tied.
    void checkTies(const std::string& object) const;
    /// Throws an Error that begins with `object` if forces cannot move joints.
    void checkDrives(const std::string& object) const;

    /// [m] The largest distance at which two surfaces at rest touch.
    [[nodiscard]] double reach() const { return 2.0 * proximity_; }
    /// The pairs that welds hold together; models read them in a step.
    [[nodiscard]] std::shared_ptr<const WeldedPairs> welded() const { return welded_; }
    void setWelded(WeldedPairs pairs) { *welded_ = std::move(pairs); }

    void start(::sofa::simulation::Node& root);
    /// A body has come, with such collision models.
    void join(const std::vector<CollisionPlan>& models);
    /// Before a step: how far contacts are looked for if nothing is faster than `speed` [m/s].
    void prepare(double speed, double dt);
    /// After a step: its contacts, in SOFA's order.
    void read(double dt, std::vector<FoundContact>& out, physics::StepReport& report) const;
    /// [N s] The impulses of all constraints in the last step.
    [[nodiscard]] std::span<const double> impulses() const;
    /// Drops all contacts: before a body goes, and after a step that failed.
    void forget();

private:
    struct Parts;
    physics::ContactMethod method_;
    double proximity_ = 0.0; ///< [m] the largest
    bool joined_ = false;    ///< a body has come since the last step
    std::unique_ptr<Parts> parts_;
    std::shared_ptr<WeldedPairs> welded_ = std::make_shared<WeldedPairs>();
    mutable std::atomic<bool> toldOfFriction_ = false;
};

} // namespace filasofia::sofaengine
