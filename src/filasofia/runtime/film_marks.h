#pragma once

#include "filasofia/mapping/map.h"
#include "filasofia/visual/visual_body.h"

#include <memory>
#include <span>
#include <vector>

namespace filasofia::runtime {

/// The film on a body as it is drawn: [m] per node of the body.
using NodeFilm = std::shared_ptr<const std::vector<float>>;

/// [m], thickness of blood that a mark of 1 - 1/e means; the materials' Beer-Lambert law has the same.
inline constexpr double kFilmDepth = 2.5e-4;

/// Adds a film to the marks of a surface's vertices. A vertex inside an element has the mean of its nodes that lie on
/// the body's surface.
void addFilm(const mapping::SoftMap& map, std::span<const float> film, std::vector<visual::SurfaceState>& states);

} // namespace filasofia::runtime
