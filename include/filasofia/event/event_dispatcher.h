#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/event/event.h"

#include <concepts>
#include <utility>

namespace filasofia::event {

/// Names an attached observer. A dispatcher never reuses a number; 0 names no observer.
struct ObserverId {
    std::uint64_t value = 0;

    constexpr explicit operator bool() const { return value != 0; }
    friend constexpr auto operator<=>(ObserverId, ObserverId) = default;
};

struct EventDispatcherDef {
    int capacity = 4096; ///< [events], in [2, 1048576], queued events; mergeable events have their own places
    int mergePlaces =
        256; ///< [-], in [1, 65536], merge keys that may be queued at the same time without using the capacity
    int maximumRounds = 64; ///< [-], in [1, 1000000], rounds of answers to answers in deliverAll() and stop()
};
constexpr auto fields(const EventDispatcherDef*)
{
    return describe("EventDispatcherDef",
                    field("capacity", &EventDispatcherDef::capacity, "events", closed(2, 1048576),
                          "number of events that may be queued; beyond it post() throws and tryPost() returns false"),
                    field("mergePlaces", &EventDispatcherDef::mergePlaces, "-", closed(1, 65536),
                          "number of merge keys that may be queued at the same time without using the capacity"),
                    field("maximumRounds", &EventDispatcherDef::maximumRounds, "-", closed(1, 1000000),
                          "number of rounds in which observers may answer events with events; more is an error"));
}

template <class E>
concept EventClass = std::derived_from<E, Event>;
/// An event class whose type is always the same.
template <class E>
concept TypedEvent = EventClass<E> && std::same_as<decltype(E::kType), const EventType>;

/// Delivers events from any thread to the observers of their type, one event at a time.
///
/// Posting never waits: it takes no lock, whatever observers do. Events that one thread posts reach an observer in the
/// order in which they were posted. An event that merged into a newer one counts as never posted; the newer one keeps
/// its own place in the order. Observers are called in the order in which they were attached.
///
/// Events are delivered either by the dispatcher's own thread (start() to stop()) or by the thread that calls
/// deliverAll(); never by two at once.
class EventDispatcher {
public:
    using Callback = std::function<void(const Event&)>;

    /// Throws an Error if a field is outside its range.
    explicit EventDispatcher(const EventDispatcherDef& def = {});
    /// Waits for a running callback, then frees what is queued without delivering it; to have it delivered, call stop()
    /// first. Must not be called from inside a callback.
    ~EventDispatcher();
    EventDispatcher(const EventDispatcher&) = delete;
    EventDispatcher& operator=(const EventDispatcher&) = delete;

    /// Calls `callback` for every event of `type` whose delivery begins after this. If a callback throws, that is
    /// logged and the observer is detached. May be called on any thread, and in callbacks.
    ObserverId attach(EventType type, Callback callback);

    /// The same for one event class. An event of another class under the same type is skipped, counted and, once per
    /// observer, logged.
    template <TypedEvent E> ObserverId on(std::function<void(const E&)> callback)
    {
        return on<E>(E::kType, std::move(callback));
    }
    template <EventClass E> ObserverId on(EventType type, std::function<void(const E&)> callback)
    {
        return attach(type, [this, callback = std::move(callback), warned = false](const Event& event) mutable {
            if (const E* typed = dynamic_cast<const E*>(&event)) {
                callback(*typed);
            } else {
                skip(event, !std::exchange(warned, true));
            }
        });
    }

    /// Ends an observer: it is not called again, and what its callback owns is freed. May be called on any thread, and
    /// in callbacks. True means that the callback is not running (also for an unknown id); detach() waits for that,
    /// unless it would wait for ever. Then it returns false at once, and the call in progress is the last. This happens
    /// inside that callback, or if the thread that runs the callback waits, directly or through others, for a callback
    /// that this thread is running (two dispatchers whose observers detach each other: the first caller waits, the
    /// second gets false).
    bool detach(ObserverId id);

    /// Queues an event. May be called on any thread, and in callbacks. Throws an Error if the queue is full.
    void post(std::unique_ptr<Event> event);
    template <EventClass E> void post(E event) { post(std::make_unique<E>(std::move(event))); }

    /// post() for physics: if the queue is full, it returns false and leaves the event with the caller. Mergeable
    /// events are refused only if the queue is full and more than `mergePlaces` keys are queued (or somewhat fewer, if
    /// their hashes collide). Allocates nothing; frees the older event that a merge replaces.
    [[nodiscard]] bool tryPost(std::unique_ptr<Event>&& event);

    /// Delivers what is queued now, what observers post from their callbacks meanwhile, and so on. Returns the number
    /// of events. Throws an Error after `maximumRounds` such rounds (what is queued then stays queued), and if events
    /// are being delivered already: by the dispatcher's thread, another caller, or the callback that makes this call.
    std::size_t deliverAll();

    /// Starts delivery on the dispatcher's own thread. Throws an Error if events are being delivered already.
    void start();
    /// Delivers what is queued on the dispatcher's own thread, as deliverAll() does, and ends that thread; does nothing
    /// if there is none. Throws an Error from inside a callback of this dispatcher and, once the thread has ended, if
    /// `maximumRounds` were not enough.
    void stop();

    [[nodiscard]] std::uint64_t merged() const;  ///< events replaced by a newer one
    [[nodiscard]] std::uint64_t refused() const; ///< events refused because the queue was full
    [[nodiscard]] std::uint64_t
    delivered() const;                           ///< events delivered, each counted once however many observers it has
    [[nodiscard]] std::uint64_t skipped() const; ///< calls skipped because the event was of another class

private:
    void skip(const Event& event, bool warn);

    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::event
