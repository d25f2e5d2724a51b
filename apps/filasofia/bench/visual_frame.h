#pragma once

#include "filasofia/visual/visual_server.h"

#include <vector>

/// The time for a picture of one surface that moves in every frame.
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

/// What is drawn of a surface of 50,176 vertices, without a window.
struct PictureScene {
    int width = 640, height = 480; ///< [pixel]
    visual::Quality quality = visual::Quality::Low;
    bool optics = false; ///< whether seen through an endoscope's optics
};

/// [s] Wall times, the graphics card's included.
struct PictureTimes {
    std::vector<double> captures = {}; ///< of each picture, from the nodes to pixels in memory
    std::vector<double> depths = {};   ///< the same of depth and labels
    double drawn = 0.0;                ///< of one picture among many that are only drawn, mean
};

PictureTimes timePictures(const PictureScene& scene, int frames);

} // namespace filasofia::app
