#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace filasofia::visual {

/// What each pixel of a picture shows: how far away it is, and what it belongs to (depth and segmentation image). Rows
/// from top to bottom. Each pixel has the values of its centre; there are no blends.
struct DepthImage {
    int width = 0;
    int height = 0;
    /// [m], distance from the camera along its viewing direction, not along the ray; kNothing where nothing is seen.
    std::vector<float> depth;
    /// VisualBodyDef::label of the body that is seen; 0 where nothing is seen or the body has no label.
    std::vector<std::uint32_t> label;

    static constexpr float kNothing = std::numeric_limits<float>::infinity();

    friend bool operator==(const DepthImage&, const DepthImage&) = default;
};

} // namespace filasofia::visual
