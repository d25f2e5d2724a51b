#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/event/event.h"

#include <concepts>
#include <utility>

namespace filasofia::event {

/// Names an attached observer. Numbers are given once per dispatcher and never used again; 0 names nobody.
struct ObserverId {
    std::uint64_t value = 0;

    constexpr explicit operator bool() const { return value != 0; }
    friend constexpr auto operator<=>(ObserverId, ObserverId) = default;
};

struct EventDispatcherDef {
    int capacity = 4096;    ///< [events], in [2, 1048576], waiting ones; mergeable events have their own places
    int mergePlaces = 256;  ///< [-], in [1, 65536], merge keys that wait at the same time without using the capacity
    int maximumRounds = 64; ///< [-], in [1, 1000000], of deliverAll() and stop(): answers to answers to answers
};
constexpr auto fields(const EventDispatcherDef*)
{
    return describe("EventDispatcherDef",
                    field("capacity", &EventDispatcherDef::capacity, "events", closed(2, 1048576),
                          "how many events may wait; beyond it post() throws and tryPost() refuses"),
                    field("mergePlaces", &EventDispatcherDef::mergePlaces, "-", closed(1, 65536),
                          "merge keys that wait at the same time without using the capacity"),
                    field("maximumRounds", &EventDispatcherDef::maximumRounds, "-", closed(1, 1000000),
                          "rounds of events that observers post in answer to events before this is an error"));
}

template <class E>
concept EventClass = std::derived_from<E, Event>;
/// An event class whose type is always the same.
template <class E>
concept TypedEvent = EventClass<E> && std::same_as<decltype(E::kType), const EventType>;

/// Brings events from any thread to the observers of their type, one event at a time.
///
/// Posting never waits: no lock is taken, whatever observers do. Events that one thread posts reach an observer in the
/// order in which they were posted; an event that merged into a newer one is as if it had never been posted, the newer
/// keeps its own place in the order. Observers are called in the order in which they were attached.
///
/// Either the dispatcher's own thread delivers (start() to stop()), or whoever calls deliverAll(); never two at once.
class EventDispatcher {
public:
    using Callback = std::function<void(const Event&)>;

    /// Throws an Error where a field is outside its range.
    explicit EventDispatcher(const EventDispatcherDef& def = {});
    /// Waits for a running callback, then frees what is queued without delivering it: call stop() first where it
    /// matters. Not from inside a callback.
    ~EventDispatcher();
    EventDispatcher(const EventDispatcher&) = delete;
    EventDispatcher& operator=(const EventDispatcher&) = delete;

    /// Calls `callback` for every event of `type` whose delivery begins after this. A callback that throws is logged
    /// and detached. Any thread, callbacks too.
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

    /// Ends an observer: it is not called again, and what its callback holds is freed. Any thread, callbacks too.
    /// True: the callback is not running (an unknown id is none). It waits for that, except where waiting would never
    /// end; then it returns false at once and the call that is running is the last: from inside that callback, or
    /// when the thread that runs it waits, directly or through others, for a callback that this thread is running
    /// (observers of two dispatchers that detach each other: the first to ask waits, the second gets false).
    bool detach(ObserverId id);

    /// Queues an event. Any thread, callbacks too. Throws an Error where the queue is full.
    void post(std::unique_ptr<Event> event);
    template <EventClass E> void post(E event) { post(std::make_unique<E>(std::move(event))); }

    /// post() for physics: where the queue is full it returns false and leaves the event with the caller. Mergeable
    /// events are refused only when the queue is full and more than `mergePlaces` keys wait (or, by bad luck in their
    /// hashes, somewhat fewer). Allocates nothing; an older event that gives way is freed here.
    [[nodiscard]] bool tryPost(std::unique_ptr<Event>&& event);

    /// Delivers what is queued now, and what observers post from their callbacks meanwhile, and so on. Returns how
    /// many events. Throws an Error after `maximumRounds` such rounds (what is then queued stays queued), and where
    /// somebody delivers already: the own thread, another caller, or the callback that calls this.
    std::size_t deliverAll();

    /// Begins to deliver on an own thread. Throws an Error where somebody delivers already.
    void start();
    /// Delivers what is queued as deliverAll() does, on the own thread, and ends that thread; nothing where there is
    /// none. Throws an Error from inside a callback of this dispatcher, and, once the thread has ended, where
    /// `maximumRounds` were not enough.
    void stop();

    [[nodiscard]] std::uint64_t merged() const;    ///< events that gave way to a newer one
    [[nodiscard]] std::uint64_t refused() const;   ///< events that found the queue full
    [[nodiscard]] std::uint64_t delivered() const; ///< events delivered, to however many observers
    [[nodiscard]] std::uint64_t skipped() const;   ///< calls not made because the event was of another class

private:
    void skip(const Event& event, bool warn);

    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::event
