#pragma once

#include "filasofia/mapping/map.h"
#include "filasofia/visual/visual_body.h"

#include <memory>
#include <span>
#include <vector>

namespace filasofia::runtime {

/// What lies on a body as it is drawn, per node of the body; surface::kNoSurface where there is none.
using NodeFilm = std::shared_ptr<const std::vector<float>>;

struct NodeMarks {
    NodeFilm blood = {}; ///< [m], thickness; null: none
    NodeFilm heat = {};  ///< [-], Burning::levels(); null: it does not burn
    friend bool operator==(const NodeMarks&, const NodeMarks&) = default;
};

/// [m], thickness of blood that a mark of 1 - 1/e means; the materials' Beer-Lambert law has the same.
inline constexpr double kFilmDepth = 2.5e-4;

/// Adds blood to the marks of a surface's vertices. A vertex inside an element has the mean of its nodes that lie on
/// the body's surface.
void addBlood(const mapping::SoftMap& map, std::span<const float> film, std::vector<visual::SurfaceState>& states);
/// The same mean of the heat, for VisualBody::setHeat(); -1, cold, where nothing is known.
std::vector<float> heatOf(const mapping::SoftMap& map, std::span<const float> film, std::size_t vertices);

} // namespace filasofia::runtime
