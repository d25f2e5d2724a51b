#pragma once

#include "filasofia/event/bounded_queue.h"
#include "filasofia/event/event.h"

namespace filasofia::event {

/// An event and its position in the order of all events.
struct QueuedEvent {
    std::uint64_t stamp = 0;
    std::optional<MergeKey> key;
    std::unique_ptr<Event> event;
};

/// The queue of posted events. Any thread pushes and never waits; one thread at a time collects.
///
/// Ordinary events go through a ring. A mergeable event goes to one of the places that its key hashes to, where it
/// replaces a queued event with the same key. If these places are all taken, or another thread is using them at that
/// moment, the event goes through the ring too and merges when it is collected.
class EventQueue {
public:
    EventQueue(std::size_t capacity, std::size_t mergePlaces);

    /// False if there is no room; then `event` stays with the caller.
    [[nodiscard]] bool tryPush(std::unique_ptr<Event>& event);

    /// Replaces `batch` by all that was pushed before this call, in the order of the stamps, one event per merge key.
    /// Waits for writers that are between two instructions of a push; they never wait for the reader.
    void collect(std::vector<QueuedEvent>& batch);

    [[nodiscard]] std::uint64_t merged() const { return merged_.load(std::memory_order_relaxed); }

private:
    enum class State : std::uint8_t { Free, Busy, Full };
    struct alignas(64) Place {
        std::atomic<State> state = State::Free;
        QueuedEvent held; // touched only by the thread that made the state Busy
    };

    bool tryMerge(QueuedEvent& item);
    void collectPlaces(std::uint64_t horizon, std::vector<QueuedEvent>& batch);
    void collectRing(std::uint64_t horizon, std::vector<QueuedEvent>& batch);
    void mergeWithin(std::vector<QueuedEvent>& batch);

    BoundedQueue<QueuedEvent> ring_;
    std::vector<Place> places_;
    std::atomic<std::uint64_t> stamp_ = 0; // stamp of the next event
    std::atomic<std::uint64_t> merged_ = 0;
};

} // namespace filasofia::event
