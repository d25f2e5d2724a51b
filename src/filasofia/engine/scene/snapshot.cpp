#include "filasofia/engine/scene/snapshot.h"

namespace filasofia::engine {

Snapshot::Snapshot(const Scene& scene) : rigid_(scene.rigid), state_(scene)
{
    for (const SoftBody& body : scene.soft) {
        softModels_.push_back(body.model);
        softStates_.push_back(body.state);
    }
}

void Snapshot::restore(Scene& scene) const
{
    static_cast<SceneState&>(scene) = state_;
    scene.rigid = rigid_;
    scene.soft.resize(softModels_.size());
    for (std::size_t b = 0; b < softModels_.size(); ++b) {
        scene.soft[b].model = softModels_[b];
        scene.soft[b].state = softStates_[b];
    }
}

} // namespace filasofia::engine
