#pragma once

#include "filasofia/runtime/scene_events.h"

#include <deque>
#include <mutex>

namespace filasofia::runtime {

/// Carries scene events, each with the step after which it happened, from any caller to the recording. Open from the
/// simulation's construction, because the scene is made before the run; closed as soon as it is known that nothing is
/// recorded. Any thread, except for observe().
class SceneJournal {
public:
    void add(std::uint64_t step, SceneEvent event);
    /// The oldest event that happened before this step was made.
    std::optional<SceneEvent> takeBefore(std::uint64_t step);
    void close();

    /// Makes observe() work from now on.
    void watch() { watching_.store(true); }
    /// Adds an event if lights, cameras, views, surroundings or the pool have changed since the last call. The visual
    /// server's thread.
    void observe(const visual::VisualServer& visual, std::uint64_t step);

private:
    struct Entry {
        std::uint64_t step = 0;
        SceneEvent event;
    };
    std::mutex mutex_;
    std::deque<Entry> entries_;
    bool open_ = true;
    std::atomic<bool> watching_ = false;
    std::string stage_, places_; ///< as last recorded; used by the visual server's thread
};

} // namespace filasofia::runtime
