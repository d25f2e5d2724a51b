#include "filasofia/runtime/film_marks.h"

#include "filasofia/surface/body_surface.h"

#include <algorithm>
#include <cmath>

namespace filasofia::runtime {
namespace {

constexpr double kWet = 2e-5; ///< [m], thickness from which on a surface glistens all over

float valueAt(std::span<const float> film, int node)
{
    return node < static_cast<int>(film.size()) ? film[static_cast<std::size_t>(node)] : surface::kNoSurface;
}

/// Calls `use` with each vertex that has a value, and the value.
template <class Use>
void forEachVertex(const mapping::SoftMap& map, std::span<const float> film, std::size_t vertices, const Use& use)
{
    if (const auto* identity = std::get_if<mapping::IdentityMap>(&map))
        for (std::size_t v = 0; v < vertices; ++v)
            if (const float here = valueAt(film, identity->nodes[v]); here > surface::kNoSurface) use(v, double(here));
    const auto* inside = std::get_if<mapping::BarycentricMap>(&map);
    for (std::size_t v = 0; inside != nullptr && v < vertices; ++v) {
        double sum = 0.0, weights = 0.0;
        for (int k = 0; k < 4; ++k) {
            const double weight = std::max(inside->embedding.weights[v][k], 0.0);
            const float here = valueAt(film, inside->embedding.nodes[v][k]);
            if (here == surface::kNoSurface) continue;
            sum += weight * here;
            weights += weight;
        }
        if (weights > 0.0) use(v, sum / weights);
    }
}

} // namespace

void addBlood(const mapping::SoftMap& map, std::span<const float> film, std::vector<visual::SurfaceState>& states)
{
    forEachVertex(map, film, states.size(), [&](std::size_t v, double thickness) {
        states[v].blood = std::max(states[v].blood, std::min(-std::expm1(-thickness / kFilmDepth), 1.0));
        states[v].wetness = std::max(states[v].wetness, std::min(thickness / kWet, 1.0));
    });
}

std::vector<float> heatOf(const mapping::SoftMap& map, std::span<const float> film, std::size_t vertices)
{
    std::vector<float> levels(vertices, -1.0F);
    forEachVertex(map, film, vertices,
                  [&](std::size_t v, double level) { levels[v] = std::clamp(static_cast<float>(level), -1.0F, 3.0F); });
    return levels;
}

} // namespace filasofia::runtime
