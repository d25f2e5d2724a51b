#pragma once

#include "filasofia/runtime/replay.h"
#include "filasofia/runtime/simulation_impl.h"
#include "filasofia/runtime/video_file.h"

namespace filasofia::runtime {

/// Draws a recorded run from the scene events of its recording.
class ScenePlayer {
public:
    /// A Replayer steps `impl`. If neither a picture nor a video is asked for, nothing is drawn.
    ScenePlayer(Simulation::Impl& impl, const ReplayDef& def);

    /// Takes what happened before the next step. Events that name bodies of that step wait for it.
    void take(const std::vector<record::SceneRecord>& scene);
    /// Call it when the bodies of the step are known.
    void beforeStep();
    /// After a step: lets blood flow and heat spread.
    void afterStep();
    /// Draws the last step, once everything that happened after it is known.
    void draw();
    void last(ReplayReport& report);

private:
    void apply(const SceneEvent& event);
    void apply(const SceneBegan& began);
    void apply(const SceneFile& file);
    void apply(const SceneShown& shown);
    void apply(const SceneVisible& visible);
    void apply(const SceneMaterial& material);
    void apply(const SceneUnshown& unshown);
    void apply(const ScenePainted& painted);
    void apply(const SceneCleaned&);
    void apply(const SceneBled& bled);
    void apply(const SceneTreated& treated);
    void apply(const SceneBurnt& burnt);
    void apply(const SceneElectrode& electrode);
    void apply(const SceneActivated& activated);
    void apply(const SceneDuct&) {} ///< nothing of it is drawn
    void apply(const SceneSmoke& smoke);
    void apply(const SceneExtracted& extracted);
    void apply(const SceneDistension& distension);
    void apply(const SceneDistended& distended);
    void apply(const SceneStage& stage);
    void apply(const ScenePlaces& places);
    [[nodiscard]] bool knows(const SceneEvent& event) const;
    [[nodiscard]] ShownId shownBy(std::uint32_t recorded) const;
    void open();
    void setStage();
    void setPlaces();

    Simulation::Impl& impl_;
    const ReplayDef& def_;
    const bool drawing_;
    SceneBegan began_ = {};
    std::vector<SceneEvent> waiting_;
    std::map<std::uint32_t, ShownId> shown_; ///< by the number in the recording
    std::optional<SceneStage> stage_;
    ScenePlaces places_;                   ///< the newest
    std::vector<visual::Camera*> cameras_; ///< made for the stage, like the two lists below
    std::vector<visual::Light*> lights_;
    std::vector<visual::View*> views_;
    const DrawnBindings drawn_{impl_.bindings};
    std::unique_ptr<visual::VisualServer> visual_;
    std::optional<VideoFile> video_;
    bool lookIsLacking_ = false;
};

} // namespace filasofia::runtime
