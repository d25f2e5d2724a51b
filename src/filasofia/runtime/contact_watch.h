#pragma once

#include "filasofia/runtime/contact_event.h"
#include "filasofia/runtime/run.h"

#include "filasofia/physics/step.h"

#include <functional>
#include <map>
#include <utility>

namespace filasofia::physics {
class PhysicsServer;
}

namespace filasofia::runtime {

/// The name of a body, for reports; also if it has been removed.
std::string nameOf(BodyId id, const physics::PhysicsServer& physics);

/// Watches which bodies touch, from step to step. Used by the stepping thread, and by others after it has ended.
class ContactWatch {
public:
    /// Takes an event; returns false if it could not.
    using Post = std::function<bool(std::unique_ptr<ContactEvent>)>;

    /// Forgets the statistics of the last run. Pairs that touch keep doing so.
    void beginRun();
    /// Whether there is anything to look at after a step. Costs nothing if nothing touches.
    [[nodiscard]] bool concerns(const physics::StepReport& report) const;
    /// Call it with the contacts of every step that concerns it. `solved`: no solver stopped short of its tolerance.
    /// Returns false if an event was lost.
    bool observe(const std::vector<frame::Contact>& contacts, bool solved, const Post& post);
    /// The statistics since beginRun(), ascending by the bodies' ids.
    [[nodiscard]] std::vector<ContactPairReport> report(const physics::PhysicsServer& physics) const;

private:
    struct Watched {
        frame::ContactPair now = {}; ///< in the newest step
        bool touched = false;        ///< in the step before
        bool touches = false;        ///< in the newest step
        std::uint64_t steps = 0, unsolved = 0;
        double normal = 0.0, maxNormal = 0.0;     ///< [N], sum over the solved steps, and maximum
        double friction = 0.0, maxFriction = 0.0; ///< [N], sum over the solved steps, and maximum
        double maxUnsolved = 0.0;                 ///< [N], maximum of the normal force over the others
        double deepest = 0.0;                     ///< [m], >= 0, deepest penetration

        void count(bool solved);
    };

    std::map<std::pair<BodyId, BodyId>, Watched> pairs_; ///< pairs that have ever touched
    int touching_ = 0;                                   ///< number of pairs that touched in the newest step
};

} // namespace filasofia::runtime
