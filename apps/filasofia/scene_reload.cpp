#include "apps/filasofia/scene_reload.h"

#include "filasofia/core/log.h"

#include <chrono>

namespace filasofia::app {
namespace {

/// How often the files are looked at. An editor writes a file in several steps, so one that still changes is left alone
/// until the next look.
constexpr std::chrono::milliseconds kBetweenLooks{200};

} // namespace

SceneReload::SceneReload(const LoadedScene& scene, std::function<LoadedScene()> load, std::function<void()> ready)
    : files_(scene.def.files), since_(scene.since), load_(std::move(load)), ready_(std::move(ready)),
      thread_([this] { work(); })
{
}

SceneReload::~SceneReload()
{
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    wake_.notify_one();
    thread_.join();
}

void SceneReload::ask()
{
    {
        const std::lock_guard lock(mutex_);
        asked_ = true;
    }
    wake_.notify_one();
}

SceneReload::State SceneReload::look() const
{
    State state(files_.size());
    for (std::size_t i = 0; i < files_.size(); ++i) {
        std::error_code problem;
        const auto written = std::filesystem::last_write_time(files_[i], problem);
        if (problem) continue;
        const auto size = std::filesystem::file_size(files_[i], problem);
        if (!problem) state[i] = {written, size};
    }
    return state;
}

void SceneReload::work()
{
    State before = look(), made = before; // the last look, and the scene that runs or was refused
    for (auto& each : made) // written meanwhile: not what runs; the clock of a file system is some milliseconds coarse
        if (each && each->first > since_ - std::chrono::milliseconds(10)) each.reset();
    for (bool asked = false;;) {
        {
            std::unique_lock lock(mutex_);
            wake_.wait_for(lock, kBetweenLooks, [this] { return asked_ || ending_; });
            if (ending_) return;
            asked = std::exchange(asked_, false);
        }
        State now = look();
        const bool stable = now == std::exchange(before, now);
        if (!asked && (now == made || !stable)) continue;
        made = std::move(now);
        try {
            next_ = load_();
        } catch (const std::exception& problem) {
            logError(problem.what());
            logInfo("the scene goes on as it was");
            continue;
        }
        ready_();
        return;
    }
}

} // namespace filasofia::app
