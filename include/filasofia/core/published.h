#pragma once

#include <array>
#include <atomic>
#include <utility>

namespace filasofia {

/// The newest of a value, of any type, from one writer at a time to any number of readers. Nobody waits for anybody; as
/// frame::FramePool, of which this is the general case, with copies in place of holds.
template <class T> class Published {
public:
    explicit Published(T first = {}) { slots_[0].value = std::move(first); }

    void write(const T& value)
    {
        // A reader is in a slot for one copy: of eight there is one free, unless seven threads copy at this moment.
        for (int i = 0;; i = (i + 1) % kSlots) {
            int free = 0;
            if (i == newest_.load(std::memory_order_relaxed) ||
                !slots_[i].readers.compare_exchange_strong(free, kWriting, std::memory_order_acquire))
                continue;
            slots_[i].value = value;
            slots_[i].readers.store(0, std::memory_order_release);
            newest_.store(i, std::memory_order_release);
            return;
        }
    }

    [[nodiscard]] T read() const
    {
        for (;;) {
            const int newest = newest_.load(std::memory_order_acquire);
            Slot& slot = slots_[newest];
            int readers = slot.readers.load(std::memory_order_relaxed);
            while (readers != kWriting &&
                   !slot.readers.compare_exchange_weak(readers, readers + 1, std::memory_order_acquire)) {
            }
            if (readers == kWriting) continue; // a newer one has been published since: look again
            // Held up in between, a reader may have got a slot that is newer than newest_ yet says: the next read would
            // go back in time.
            const bool isNewest = newest_.load(std::memory_order_acquire) == newest;
            T value = isNewest ? slot.value : T{};
            slot.readers.fetch_sub(1, std::memory_order_release);
            if (isNewest) return value;
        }
    }

private:
    static constexpr int kSlots = 8;
    static constexpr int kWriting = -1; ///< value of Slot::readers while the slot is written
    struct Slot {
        T value = {};
        std::atomic<int> readers = 0;
    };
    mutable std::array<Slot, kSlots> slots_;
    std::atomic<int> newest_ = 0;
};

} // namespace filasofia
