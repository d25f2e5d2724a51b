#pragma once

#include "filasofia/core/assert.h"

#include <atomic>
#include <cstddef>
#include <vector>

namespace filasofia {

/// A ring of fixed size between one writer and one reader; neither waits and nothing is allocated after construction.
/// Elements stay in place and keep their content (vectors their capacity): the writer fills the slot that it gets.
template <class T> class SpscRing {
public:
    explicit SpscRing(std::size_t capacity) : slots_(capacity) { FILASOFIA_ASSERT(capacity > 0); }

    /// The slot to fill next, or nullptr if the reader is a whole ring behind. Writer only; publish() makes it visible.
    [[nodiscard]] T* beginWrite()
    {
        const std::size_t written = written_.load(std::memory_order_relaxed);
        if (written - read_.load(std::memory_order_acquire) == slots_.size()) return nullptr;
        return &slots_[written % slots_.size()];
    }
    void publish() { written_.fetch_add(1, std::memory_order_release); }

    /// The oldest unread element, or nullptr. Reader only; release() frees its slot.
    [[nodiscard]] T* beginRead()
    {
        const std::size_t read = read_.load(std::memory_order_relaxed);
        if (written_.load(std::memory_order_acquire) == read) return nullptr;
        return &slots_[read % slots_.size()];
    }
    void release() { read_.fetch_add(1, std::memory_order_release); }

private:
    std::vector<T> slots_;
    std::atomic<std::size_t> written_ = 0;
    std::atomic<std::size_t> read_ = 0;
};

} // namespace filasofia
