#pragma once

#include "filasofia/frame/frame.h"

#include <array>
#include <atomic>
#include <utility>

namespace filasofia::frame {

class FramePool;

/// A reader's reference to a published Frame; while it lives, the Frame does not change.
class FrameRef {
public:
    FrameRef() = default;
    FrameRef(FrameRef&& other) noexcept : frame_(std::exchange(other.frame_, nullptr)), readers_(other.readers_) {}
    FrameRef& operator=(FrameRef&& other) noexcept
    {
        std::swap(frame_, other.frame_);
        std::swap(readers_, other.readers_);
        return *this;
    }
    ~FrameRef()
    {
        if (frame_) readers_->fetch_sub(1, std::memory_order_release);
    }

    explicit operator bool() const { return frame_ != nullptr; }
    const Frame& operator*() const { return *frame_; }
    const Frame* operator->() const { return frame_; }

private:
    friend class FramePool;
    FrameRef(const Frame* frame, std::atomic<int>* readers) : frame_(frame), readers_(readers) {}

    const Frame* frame_ = nullptr;
    std::atomic<int>* readers_ = nullptr;
};

/// Passes the newest Frame from one writer to any number of readers. Lossy: a reader sees the newest frame, not every
/// one. Nobody waits, and once the frames have grown to the bodies' sizes nothing is allocated.
class FramePool {
public:
    /// Readers may hold two frames fewer than this at once; if they hold more, the writer skips a frame.
    static constexpr int kFrames = 8;

    /// Writer: a Frame to fill, or nullptr if readers hold all of them. publish() must follow.
    [[nodiscard]] Frame* beginWrite();
    void publish();

    /// Any thread: the newest Frame; empty before the first one.
    [[nodiscard]] FrameRef latest();

private:
    static constexpr int kWriting = -1; ///< value of Slot::readers while the writer fills the frame
    struct Slot {
        Frame frame;
        std::atomic<int> readers = 0;
    };
    std::array<Slot, kFrames> slots_;
    std::atomic<int> newest_ = -1;
    int writing_ = -1;
};

} // namespace filasofia::frame
