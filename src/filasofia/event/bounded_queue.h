#pragma once

#include "filasofia/core/assert.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace filasofia::event {

/// A queue of fixed size: any thread pushes without waiting, one thread at a time reads. Nothing is allocated after
/// construction. This is the array queue of Vyukov ("Bounded MPMC queue", 1024cores.net): a cell's sequence number says
/// whether it may be written or read. Positions are 64 bits and never wrap, so the capacity need not be a power of two.
template <class T> class BoundedQueue {
public:
    explicit BoundedQueue(std::size_t capacity) : cells_(capacity)
    {
        FILASOFIA_ASSERT(capacity >= 2); // in a ring of one cell, "written" and "free again" would be the same number
        for (std::size_t i = 0; i < capacity; ++i) cells_[i].sequence.store(i, std::memory_order_relaxed);
    }

    /// False if the queue is full; then `value` is unchanged.
    [[nodiscard]] bool tryPush(T& value)
    {
        std::uint64_t position = tail_.load(std::memory_order_relaxed);
        for (;;) {
            Cell& cell = cells_[position % cells_.size()];
            const auto turn = static_cast<std::int64_t>(cell.sequence.load(std::memory_order_acquire) - position);
            if (turn < 0) return false; // the cell still holds what was written one round ago
            if (turn > 0) {
                position = tail_.load(std::memory_order_relaxed); // another writer took it
            } else if (tail_.compare_exchange_weak(position, position + 1, std::memory_order_acq_rel,
                                                   std::memory_order_relaxed)) {
                cell.value = std::move(value);
                cell.sequence.store(position + 1, std::memory_order_release);
                return true;
            }
        }
    }

    /// The number of cells that writers have claimed since construction; the last of them may not be written yet.
    [[nodiscard]] std::uint64_t claimed() const { return tail_.load(std::memory_order_acquire); }

    /// The number of cells that the reader has released. Reader only.
    [[nodiscard]] std::uint64_t read() const { return head_; }
    /// The oldest cell, or nullptr if it is not written yet. Reader only.
    [[nodiscard]] T* front()
    {
        Cell& cell = cells_[head_ % cells_.size()];
        return cell.sequence.load(std::memory_order_acquire) == head_ + 1 ? &cell.value : nullptr;
    }
    /// Releases the oldest cell. Reader only, after front().
    void pop()
    {
        Cell& cell = cells_[head_ % cells_.size()];
        cell.value = T{};
        cell.sequence.store(head_ + cells_.size(), std::memory_order_release);
        ++head_;
    }

private:
    struct Cell {
        std::atomic<std::uint64_t> sequence = 0;
        T value{};
    };
    std::vector<Cell> cells_;
    alignas(64) std::atomic<std::uint64_t> tail_ =
        0; // apart from the reader's cache line, because writers access it constantly
    alignas(64) std::uint64_t head_ = 0;
};

} // namespace filasofia::event
