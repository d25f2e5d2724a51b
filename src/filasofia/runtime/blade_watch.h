#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/event/event_dispatcher.h"

#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace filasofia::physics {
class PhysicsServer;
}

namespace filasofia::runtime {

class ContactEvent;

/// Finds blades that touch soft tissue that cannot be cut. They push it like any other shape, which usually means that
/// `dynamicTopology` was forgotten. Logs a warning once per pair of bodies, and adds a line to the summary of the run.
class BladeWatch {
public:
    /// Both outlive it. It works on the thread that delivers events, so that no step pays for it.
    BladeWatch(event::EventDispatcher& events, const physics::PhysicsServer& physics);
    ~BladeWatch();
    BladeWatch(const BladeWatch&) = delete;
    BladeWatch& operator=(const BladeWatch&) = delete;

    /// One line per pair, in the order in which they met. Any thread.
    [[nodiscard]] std::vector<std::string> lines() const;

private:
    void look(const ContactEvent& contact);

    event::EventDispatcher& events_;
    const physics::PhysicsServer& physics_;
    mutable std::mutex mutex_; ///< guards the members below
    std::set<std::pair<BodyId, BodyId>> met_;
    std::vector<std::string> lines_;
    event::ObserverId observer_;
};

} // namespace filasofia::runtime
