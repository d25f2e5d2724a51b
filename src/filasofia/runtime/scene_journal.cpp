#include "filasofia/runtime/scene_journal.h"

#include "filasofia/runtime/bindings.h"

#include <algorithm>

namespace filasofia::runtime {
namespace {

SceneStage stageOf(const visual::VisualServer& visual)
{
    SceneStage stage{.environment = visual.environment()};
    for (const auto& [name, material] : visual.materials())
        if (!name.starts_with(kInteriorOf))
            stage.materials.push_back({name, material}); // the others are rebuilt automatically
    const std::vector<visual::Camera*> cameras = visual.cameras();
    for (const visual::Camera* camera : cameras) stage.cameras.push_back(camera->def());
    for (const visual::Light* light : visual.lights()) stage.lights.push_back(light->def());
    for (const visual::View* view : visual.views()) {
        const auto camera = std::ranges::find(cameras, &view->camera());
        stage.views.push_back({view->def(), static_cast<int>(camera - cameras.begin()), view->visible()});
    }
    return stage;
}

StagePlace placeOf(const visual::Transform& transform) { return {transform.worldPose(), transform.worldVisible()}; }

} // namespace

void SceneJournal::add(std::uint64_t step, SceneEvent event)
{
    const std::lock_guard lock(mutex_);
    if (open_) entries_.push_back({step, std::move(event)});
}

std::optional<SceneEvent> SceneJournal::takeBefore(std::uint64_t step)
{
    const std::lock_guard lock(mutex_);
    if (entries_.empty() || entries_.front().step >= step) return std::nullopt;
    SceneEvent event = std::move(entries_.front().event);
    entries_.pop_front();
    return event;
}

void SceneJournal::close()
{
    const std::lock_guard lock(mutex_);
    open_ = false;
    entries_.clear();
    watching_.store(false);
}

void SceneJournal::observe(const visual::VisualServer& visual, std::uint64_t step)
{
    if (!watching_.load(std::memory_order_relaxed)) return;
    SceneStage stage = stageOf(visual);
    if (std::string words = recordOf(stage).words; words != stage_) {
        stage_ = std::move(words);
        places_.clear();
        add(step, std::move(stage));
    }
    ScenePlaces places;
    for (const visual::Camera* camera : visual.cameras()) places.cameras.push_back(placeOf(*camera));
    for (const visual::Light* light : visual.lights()) places.lights.push_back(placeOf(*light));
    if (std::string words = recordOf(places).words; words != places_) {
        places_ = std::move(words);
        add(step, std::move(places));
    }
}

} // namespace filasofia::runtime
