#include "filasofia/frame/frame_pool.h"

#include "filasofia/core/assert.h"

namespace filasofia::frame {

Frame* FramePool::beginWrite()
{
    FILASOFIA_ASSERT(writing_ < 0);
    const int newest = newest_.load(std::memory_order_relaxed);
    for (int i = 0; i < kFrames; ++i) {
        int free = 0;
        if (i == newest || !slots_[i].readers.compare_exchange_strong(free, kWriting, std::memory_order_acquire))
            continue;
        writing_ = i;
        return &slots_[i].frame;
    }
    return nullptr;
}

void FramePool::publish()
{
    FILASOFIA_ASSERT(writing_ >= 0);
    slots_[writing_].readers.store(0, std::memory_order_release);
    newest_.store(writing_, std::memory_order_release);
    writing_ = -1;
}

FrameRef FramePool::latest()
{
    for (;;) {
        const int newest = newest_.load(std::memory_order_acquire);
        if (newest < 0) return {};
        // The writer may take the slot between the two loads, but only after publishing a newer one: look again.
        Slot& slot = slots_[newest];
        int readers = slot.readers.load(std::memory_order_relaxed);
        while (readers != kWriting &&
               !slot.readers.compare_exchange_weak(readers, readers + 1, std::memory_order_acquire)) {
        }
        if (readers == kWriting) continue;
        // If it is delayed in between, a reader may get a slot that is just being published and is newer than newest_
        // says; its next look would go back in time. So the slot is kept only if it is still the newest.
        if (newest_.load(std::memory_order_acquire) != newest) {
            slot.readers.fetch_sub(1, std::memory_order_release);
            continue;
        }
        return {&slot.frame, &slot.readers};
    }
}

} // namespace filasofia::frame
