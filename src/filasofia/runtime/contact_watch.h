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

/// Who touches whom, from step to step. Used by the stepping thread, and by others when that has ended.
class ContactWatch {
public:
    /// Takes an event; false where it could not.
    using Post = std::function<bool(std::unique_ptr<ContactEvent>)>;

    /// Forgets the figures of the last run; what touches goes on touching.
    void beginRun();
    /// Is there anything to look at after a step. Costs nothing where nothing touches.
    [[nodiscard]] bool concerns(const physics::StepReport& report) const;
    /// Told of the contacts of every step that concerns it; false where an event was lost.
    bool observe(const std::vector<frame::Contact>& contacts, const Post& post);
    /// The figures since beginRun(), ascending by the bodies' ids.
    [[nodiscard]] std::vector<ContactPairReport> report(const physics::PhysicsServer& physics) const;

private:
    struct Watched {
        frame::ContactPair now = {}; ///< of the newest step
        bool touched = false;        ///< in the step before
        bool touches = false;        ///< in the newest step
        std::uint64_t steps = 0;
        double normal = 0.0, mostNormal = 0.0;     ///< [N] sum over the steps, and the largest
        double friction = 0.0, mostFriction = 0.0; ///< [N]
        double deepest = 0.0;                      ///< [m]

        void count();
    };

    std::map<std::pair<BodyId, BodyId>, Watched> pairs_; ///< that ever touched
    int touching_ = 0;                                   ///< pairs that did in the newest step
};

} // namespace filasofia::runtime
