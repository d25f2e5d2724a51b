#pragma once

#include "filasofia/runtime/replay.h"
#include "filasofia/runtime/simulation_impl.h"
#include "filasofia/runtime/video_file.h"

namespace filasofia::runtime {

/// Draws a recorded run from what its recording tells of the scene.
class ScenePlayer {
public:
    /// `impl` is made again by a Replayer; with neither picture nor video asked for, nothing is drawn.
    ScenePlayer(Simulation::Impl& impl, const ReplayDef& def);

    /// What happened before the step that is made next. Events that name bodies of that step wait for it.
    void take(const std::vector<record::SceneRecord>& scene);
    /// The step's bodies are known.
    void beforeStep();
    /// Of the last step, once what happened after it is known.
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
    std::map<std::uint32_t, ShownId> shown_; ///< by the number that the recording has
    std::optional<SceneStage> stage_;
    ScenePlaces places_;                   ///< the newest
    std::vector<visual::Camera*> cameras_; ///< of the stage, like these
    std::vector<visual::Light*> lights_;
    std::vector<visual::View*> views_;
    const DrawnBindings drawn_{impl_.bindings};
    std::unique_ptr<visual::VisualServer> visual_;
    std::optional<VideoFile> video_;
    bool lookIsLacking_ = false;
};

} // namespace filasofia::runtime
