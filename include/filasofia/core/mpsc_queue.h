#pragma once

#include <atomic>
#include <optional>
#include <utility>

namespace filasofia {

/// An unbounded queue: any thread pushes, one thread pops, and neither ever waits for the other. After push() has
/// returned, the next pop() finds the element, even while other threads push. The pushed elements form a stack
/// (Treiber 1986), which pop() takes as a whole and reverses; nothing is taken from the middle, so a reused address
/// (ABA) does no harm.
template <class T> class MpscQueue {
public:
    MpscQueue() = default;
    MpscQueue(const MpscQueue&) = delete;
    MpscQueue& operator=(const MpscQueue&) = delete;
    ~MpscQueue()
    {
        while (pop()) {
        }
    }

    void push(T value)
    {
        Node* node = new Node{std::move(value), newest_.load(std::memory_order_relaxed)};
        while (!newest_.compare_exchange_weak(node->next, node, std::memory_order_release, std::memory_order_relaxed)) {
        }
    }

    std::optional<T> pop()
    {
        if (!oldest_) takePushed();
        if (!oldest_) return std::nullopt;
        Node* node = std::exchange(oldest_, oldest_->next);
        std::optional<T> value = std::move(node->value);
        delete node;
        return value;
    }

private:
    struct Node {
        T value;
        Node* next = nullptr;
    };
    void takePushed()
    {
        if (!newest_.load(std::memory_order_relaxed)) return; // the usual case: no write to the shared line
        for (Node* node = newest_.exchange(nullptr, std::memory_order_acquire); node;) {
            Node* older = std::exchange(node->next, oldest_);
            oldest_ = std::exchange(node, older);
        }
    }

    std::atomic<Node*> newest_ = nullptr;
    Node* oldest_ = nullptr; ///< taken by the reader, oldest first
};

} // namespace filasofia
