#pragma once

#include "filasofia/scene/scene_file.h"

#include <condition_variable>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

namespace filasofia::app {

/// A scene and the simulation made of it.
struct LoadedScene {
    std::filesystem::file_time_type since = {}; ///< its files are read as they were then, or later
    scene::SceneDef def = {};
    std::unique_ptr<runtime::Simulation> simulation = {};
    scene::AddedScene added = {}; ///< it ends before the simulation
};

/// While a scene runs in a window: makes it anew, on a thread of its own, each time its files have changed, or when
/// it is asked to. A scene that is wrong is logged, and the one that runs goes on.
class SceneReload {
public:
    /// `load` makes the scene anew; `ready` is called once, on the thread, when a new one is there.
    SceneReload(const LoadedScene& scene, std::function<LoadedScene()> load, std::function<void()> ready);
    ~SceneReload();
    SceneReload(const SceneReload&) = delete;
    SceneReload& operator=(const SceneReload&) = delete;

    /// Makes it anew although no file has changed. Any thread.
    void ask();
    /// The new scene, after `ready` was called.
    [[nodiscard]] LoadedScene take() { return std::move(next_); }

private:
    /// When each file was written and its size; nothing for one that is not there.
    using State = std::vector<std::optional<std::pair<std::filesystem::file_time_type, std::uintmax_t>>>;
    [[nodiscard]] State look() const;
    void work();

    const std::vector<std::filesystem::path> files_;
    const std::filesystem::file_time_type since_;
    const std::function<LoadedScene()> load_;
    const std::function<void()> ready_;
    LoadedScene next_;
    std::mutex mutex_;
    std::condition_variable wake_;
    bool asked_ = false, ending_ = false; ///< under the lock
    std::thread thread_;                  ///< last, because it uses all other members
};

} // namespace filasofia::app
