#pragma once

#include <array>
#include <atomic>
#include <utility>

namespace filasofia {

/// Passes the newest value of any type from one writer at a time to any number of readers. No thread waits for another.
/// It works like frame::FramePool, but readers copy the value instead of holding it.
template <class T> class Published {
public:
    explicit Published(T first = {}) { slots_[0].value = std::move(first); }

    void write(const T& value)
    {
        // A reader uses a slot only while it copies: one of eight is free, unless seven threads copy at this moment.
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
            if (readers == kWriting) continue; // a newer value has been published since: try again
            // A reader that was delayed here may have got a slot that is newer than newest_ says yet: its next read
            // would go back in time.
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
