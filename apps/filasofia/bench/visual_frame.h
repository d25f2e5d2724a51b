#pragma once

#include "filasofia/visual/visual_server.h"

#include <vector>

/// What a picture of one surface costs that moves in every frame, in time of the processor.
namespace filasofia::app {

enum class MapKind { Identity, Barycentric };

/// A surface on a body, and where it is drawn.
struct FrameScene {
    int vertices = 5184; ///< drawn, after subdivision: a square times 16
    int level = 0;
    MapKind map = MapKind::Barycentric;
    visual::Backend backend = visual::Backend::Null;
};

/// [s] of one frame, of the main thread but for the last.
struct FrameTimes {
    double mapping = 0.0;
    visual::VisualStages stages = {};
    double whole = 0.0; ///< of all threads, the graphics driver's included
    [[nodiscard]] double main() const
    {
        return mapping + stages.subdivision + stages.normals + stages.upload + stages.submit;
    }
};

std::vector<FrameTimes> timeFrames(const FrameScene& scene, int frames);

/// [s] of new triangles for the same surface: on the worker's thread and on the main one.
struct TopologyTimes {
    double prepare = 0.0;
    double adopt = 0.0;
};

std::vector<TopologyTimes> timeTopology(const FrameScene& scene, int repeats);

} // namespace filasofia::app
