#pragma once

#include "filasofia/mapping/map.h"
#include "filasofia/visual/visual_body.h"

#include <memory>
#include <span>
#include <vector>

namespace filasofia::runtime {

/// What lies on a body as it is drawn, per node of the body; negative where there is no surface.
using NodeFilm = std::shared_ptr<const std::vector<float>>;

struct NodeMarks {
    NodeFilm blood = {}; ///< [m], thickness; null: none
    NodeFilm burn = {};  ///< [-], in [0, 1], how burnt it looks; null: not at all
    friend bool operator==(const NodeMarks&, const NodeMarks&) = default;
};

/// [m], thickness of blood that a mark of 1 - 1/e means; the materials' Beer-Lambert law has the same.
inline constexpr double kFilmDepth = 2.5e-4;

/// Adds blood and burns to the marks of a surface's vertices. A vertex inside an element has the mean of its nodes that
/// lie on the body's surface.
void addMarks(const mapping::SoftMap& map, const NodeMarks& marks, std::vector<visual::SurfaceState>& states);

} // namespace filasofia::runtime
