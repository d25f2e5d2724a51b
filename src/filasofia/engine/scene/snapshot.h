#pragma once

#include "filasofia/engine/scene/scene.h"

namespace filasofia::engine {

/// A copy of a scene without its solvers and editable meshes: enough to restore the scene between two steps.
class Snapshot {
public:
    explicit Snapshot(const Scene& scene);
    void restore(Scene& scene) const;

    [[nodiscard]] const SoftModel& soft(std::size_t body) const { return softModels_[body]; }
    [[nodiscard]] const SoftState& softState(std::size_t body) const { return softStates_[body]; }
    [[nodiscard]] const RigidModel& rigid(std::size_t body) const { return rigid_[body].model; }
    [[nodiscard]] std::size_t softCount() const { return softModels_.size(); }
    [[nodiscard]] std::size_t rigidCount() const { return rigid_.size(); }

private:
    std::vector<SoftModel> softModels_;
    std::vector<SoftState> softStates_;
    std::vector<RigidBody> rigid_;
    SceneState state_;
};

} // namespace filasofia::engine
