#pragma once

#include <atomic>
#include <optional>
#include <utility>

namespace filasofia {

/// An unbounded queue: any thread pushes, one thread pops, and neither ever waits for the other.
/// Linked nodes with an atomic tail exchange (Vyukov, "Intrusive MPSC node-based queue", 1024cores.net).
/// Between the two stores of a push, pop() may miss that element; the next call finds it.
template <class T> class MpscQueue {
public:
    MpscQueue() = default;
    MpscQueue(const MpscQueue&) = delete;
    MpscQueue& operator=(const MpscQueue&) = delete;
    ~MpscQueue()
    {
        while (pop()) {
        }
        delete head_;
    }

    void push(T value)
    {
        Node* node = new Node{std::move(value)};
        Node* last = tail_.exchange(node, std::memory_order_acq_rel);
        last->next.store(node, std::memory_order_release);
    }

    std::optional<T> pop()
    {
        Node* next = head_->next.load(std::memory_order_acquire);
        if (!next) return std::nullopt;
        std::optional<T> value = std::move(next->value);
        next->value.reset();
        delete std::exchange(head_, next);
        return value;
    }

private:
    struct Node {
        std::optional<T> value;
        std::atomic<Node*> next = nullptr;
    };
    Node* head_ = new Node{}; // an empty node, whose value pop() returned last
    std::atomic<Node*> tail_ = head_;
};

} // namespace filasofia
