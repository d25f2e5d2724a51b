#include "filasofia/event/event_queue.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <thread>

namespace filasofia::event {
namespace {

constexpr std::size_t kProbes = 8; // places that one key may use: enough that a half-full table rarely refuses

std::size_t hash(const MergeKey& key)
{
    // The finalizer of splitmix64 (Steele, Lea, Flood 2014) spreads keys made of small numbers over all places.
    std::uint64_t h = key.value + 0x9e3779b97f4a7c15ull * (static_cast<std::uint64_t>(key.type) + 1);
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ull;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebull;
    return static_cast<std::size_t>(h ^ (h >> 31));
}

// The reader waits for a writer that was interrupted in the middle of a push. It eventually sleeps, because a yield
// alone would not let a writer of lower real-time priority run.
void pauseReader(int& tries)
{
    if (++tries < 64) {
        std::this_thread::yield();
    } else {
        std::this_thread::sleep_for(std::chrono::microseconds(20));
    }
}

} // namespace

EventQueue::EventQueue(std::size_t capacity, std::size_t mergePlaces) : ring_(capacity), places_(mergePlaces) {}

bool EventQueue::tryPush(std::unique_ptr<Event>& event)
{
    QueuedEvent item;
    item.key = event->mergeKey();
    // The stamp is taken before the event becomes visible: collect() relies on it.
    item.stamp = stamp_.fetch_add(1, std::memory_order_acq_rel);
    item.event = std::move(event);
    if (item.key && tryMerge(item)) return true;
    if (ring_.tryPush(item)) return true;
    event = std::move(item.event);
    return false;
}

bool EventQueue::tryMerge(QueuedEvent& item)
{
    const std::size_t first = hash(*item.key);
    for (std::size_t probe = 0; probe < std::min(kProbes, places_.size()); ++probe) {
        Place& place = places_[(first + probe) % places_.size()];
        // If another thread is using this place for a few instructions, go on rather than wait for it.
        State state = place.state.load(std::memory_order_relaxed);
        if (state == State::Busy) continue;
        if (!place.state.compare_exchange_strong(state, State::Busy, std::memory_order_acquire,
                                                 std::memory_order_relaxed))
            continue;
        if (state == State::Free) {
            place.held = std::move(item);
            place.state.store(State::Full, std::memory_order_release);
            return true;
        }
        if (place.held.key == item.key) {
            // Two threads may arrive here in another order than their stamps: the newer event stays.
            if (place.held.stamp < item.stamp) std::swap(place.held, item);
            place.held.event->absorb(*item.event);
            place.state.store(State::Full, std::memory_order_release);
            merged_.fetch_add(1, std::memory_order_relaxed);
            return true; // the older event is freed with `item`, outside the place
        }
        place.state.store(State::Full, std::memory_order_release); // the place belongs to another key
    }
    return false;
}

// Why the order of each thread is kept: let a thread push A, then B, and let B be in this batch, so stamp(B) < horizon.
// A was complete before stamp(B) was taken, hence before the horizon was read, hence it is visible below: in the ring
// (an event before it there claimed its cell earlier; one with stamp >= horizon claimed later) or in its place. So A is
// in this batch or was in an earlier one, unless a newer event of its key absorbed it.
void EventQueue::collect(std::vector<QueuedEvent>& batch)
{
    batch.clear();
    const std::uint64_t horizon = stamp_.load(std::memory_order_acquire);
    collectPlaces(horizon, batch);
    collectRing(horizon, batch);
    std::sort(batch.begin(), batch.end(), [](const auto& a, const auto& b) { return a.stamp < b.stamp; });
    mergeWithin(batch);
}

void EventQueue::collectPlaces(std::uint64_t horizon, std::vector<QueuedEvent>& batch)
{
    for (Place& place : places_) {
        State state = place.state.load(std::memory_order_acquire);
        for (int tries = 0; state != State::Free;) {
            if (state == State::Full &&
                place.state.compare_exchange_strong(state, State::Busy, std::memory_order_acquire))
                break;
            if (state == State::Busy) {
                pauseReader(tries);
                state = place.state.load(std::memory_order_acquire);
            }
        }
        if (state == State::Free) continue;
        const bool due = place.held.stamp < horizon;
        if (due) batch.push_back(std::move(place.held));
        place.state.store(due ? State::Free : State::Full, std::memory_order_release);
    }
}

void EventQueue::collectRing(std::uint64_t horizon, std::vector<QueuedEvent>& batch)
{
    const std::uint64_t claimed = ring_.claimed();
    for (int tries = 0; ring_.read() != claimed;) {
        QueuedEvent* oldest = ring_.front();
        if (!oldest) {
            pauseReader(tries);
            continue;
        }
        if (oldest->stamp >= horizon) return;
        batch.push_back(std::move(*oldest));
        ring_.pop();
    }
}

// A key may be in two places, or in the ring: the newest event absorbs the others.
void EventQueue::mergeWithin(std::vector<QueuedEvent>& batch)
{
    std::map<MergeKey, std::size_t> newest;
    for (std::size_t i = 0; i < batch.size(); ++i) {
        if (!batch[i].key) continue;
        const auto [entry, first] = newest.try_emplace(*batch[i].key, i);
        if (first) continue;
        QueuedEvent& older = batch[std::exchange(entry->second, i)];
        batch[i].event->absorb(*older.event);
        older.event.reset();
        merged_.fetch_add(1, std::memory_order_relaxed);
    }
    std::erase_if(batch, [](const QueuedEvent& item) { return !item.event; });
}

} // namespace filasofia::event
