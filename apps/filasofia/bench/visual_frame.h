#pragma once

#include "filasofia/visual/visual_server.h"

#include <vector>

/// The processor time for a picture of one surface that moves in every frame.
namespace filasofia::app {

enum class MapKind { Identity, Barycentric };

/// A surface on a body, and the backend that draws it.
struct FrameScene {
    int vertices = 5184; ///< drawn vertices, after subdivision: a square number times 16
    int level = 0;
    MapKind map = MapKind::Barycentric;
    visual::Backend backend = visual::Backend::Null;
};

/// [s] Times of one frame, all in the main thread except `whole`.
struct FrameTimes {
    double mapping = 0.0;
    visual::VisualStages stages = {};
    double whole = 0.0; ///< in all threads, the graphics driver's included
    [[nodiscard]] double main() const
    {
        return mapping + stages.subdivision + stages.normals + stages.upload + stages.submit;
    }
};

std::vector<FrameTimes> timeFrames(const FrameScene& scene, int frames);

/// [s] Times to replace the triangles of the same surface, on the worker thread and on the main thread.
struct TopologyTimes {
    double prepare = 0.0;
    double adopt = 0.0;
};

std::vector<TopologyTimes> timeTopology(const FrameScene& scene, int repeats);

} // namespace filasofia::app
