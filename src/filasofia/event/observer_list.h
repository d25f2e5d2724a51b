#pragma once

#include "filasofia/event/event_dispatcher.h"

#include <array>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace filasofia::event {

/// The observers of each event type. Any thread attaches and detaches; one thread at a time delivers. No lock is held
/// while a callback runs, and posting does not use this class.
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

    std::shared_ptr<Observer> remove(std::uint64_t id); // the caller holds the lock
    void call(Observer& observer, const Event& event);
    bool begin(const Observer& observer);
    void end(Observer& observer, bool failed);

    std::mutex mutex_; // guards everything below
    std::condition_variable ended_;
    // Lists are replaced, never changed: the delivering thread iterates over the one it found at the start of an event.
    std::array<std::shared_ptr<const Observers>, kEventTypes> lists_;
    std::uint64_t lastId_ = 0;
    std::uint64_t running_ = 0; // the observer whose callback is running; 0 if there is none
    std::thread::id runner_;
    std::vector<std::thread::id> waiters_; // threads that wait for `running_` to end
};

} // namespace filasofia::event
