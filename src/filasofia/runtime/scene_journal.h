#pragma once

#include "filasofia/runtime/scene_events.h"

#include <deque>
#include <mutex>

namespace filasofia::runtime {

/// What happens to the scene, with the step after which it happened, from whoever makes it happen to the recording.
/// Open from the simulation's beginning, as the scene is made before the run; closed when it is known that nothing is
/// recorded. Any thread, but for observe().
class SceneJournal {
public:
    void add(std::uint64_t step, SceneEvent event);
    /// The oldest event that happened before this step was made.
    std::optional<SceneEvent> takeBefore(std::uint64_t step);
    void close();

    /// From now on observe() looks.
    void watch() { watching_.store(true); }
    /// Tells what has changed of lights, cameras, views, surroundings and pool since the last time. The visual server's
    /// thread.
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
    std::string stage_, places_; ///< as they were told last; the visual server's thread's
};

} // namespace filasofia::runtime
