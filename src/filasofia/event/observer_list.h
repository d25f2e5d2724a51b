#pragma once

#include "filasofia/event/event_dispatcher.h"

#include <array>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace filasofia::event {

/// Who wants to hear of what. Any thread attaches and detaches; one thread at a time delivers. No lock is held while
/// a callback runs, and posting never comes here.
class ObserverList {
public:
    ObserverId attach(EventType type, EventDispatcher::Callback callback);
    bool detach(ObserverId id); ///< see EventDispatcher::detach()
    void deliver(const Event& event);

private:
    struct Observer {
        std::uint64_t id = 0;
        EventDispatcher::Callback callback;
        bool detached = false;
    };
    using Observers = std::vector<std::shared_ptr<Observer>>;

    std::shared_ptr<Observer> remove(std::uint64_t id); // with the lock held
    void call(Observer& observer, const Event& event);
    bool begin(const Observer& observer);
    void end(Observer& observer, bool failed);

    std::mutex mutex_; // guards all below
    std::condition_variable ended_;
    // Lists are replaced, never changed: the deliverer goes through the one it found at the start of an event.
    std::array<std::shared_ptr<const Observers>, kEventTypes> lists_;
    std::uint64_t lastId_ = 0;
    std::uint64_t running_ = 0; // the observer whose callback runs now; 0: none
    std::thread::id runner_;
    std::vector<std::thread::id> waiters_; // for `running_` to end
};

} // namespace filasofia::event
