#include "filasofia/runtime/film_marks.h"

#include <algorithm>
#include <cmath>

namespace filasofia::runtime {
namespace {

constexpr double kWet = 2e-5; ///< [m], thickness from which on a surface glistens all over

double valueAt(std::span<const float> film, int node)
{
    return node < static_cast<int>(film.size()) ? static_cast<double>(film[static_cast<std::size_t>(node)]) : -1.0;
}

void addBlood(double thickness, visual::SurfaceState& state)
{
    state.blood = std::max(state.blood, std::min(-std::expm1(-thickness / kFilmDepth), 1.0));
    state.wetness = std::max(state.wetness, std::min(thickness / kWet, 1.0));
}

void addBurn(double burn, visual::SurfaceState& state) { state.burn = std::max(state.burn, std::min(burn, 1.0)); }

template <class Add> void addFilm(const mapping::SoftMap& map, std::span<const float> film,
                                  std::vector<visual::SurfaceState>& states, const Add& add)
{
    const auto addIfAny = [&](double value, visual::SurfaceState& state) {
        if (value > 0.0) add(value, state);
    };
    if (const auto* identity = std::get_if<mapping::IdentityMap>(&map))
        for (std::size_t v = 0; v < states.size(); ++v) addIfAny(valueAt(film, identity->nodes[v]), states[v]);
    const auto* inside = std::get_if<mapping::BarycentricMap>(&map);
    for (std::size_t v = 0; inside != nullptr && v < states.size(); ++v) {
        double sum = 0.0, weights = 0.0;
        for (int k = 0; k < 4; ++k) {
            const double weight = std::max(inside->embedding.weights[v][k], 0.0);
            const double here = valueAt(film, inside->embedding.nodes[v][k]);
            if (here < 0.0) continue; // not on the surface
            sum += weight * here;
            weights += weight;
        }
        if (weights > 0.0) addIfAny(sum / weights, states[v]);
    }
}

} // namespace

void addMarks(const mapping::SoftMap& map, const NodeMarks& marks, std::vector<visual::SurfaceState>& states)
{
    if (marks.blood) addFilm(map, *marks.blood, states, addBlood);
    if (marks.burn) addFilm(map, *marks.burn, states, addBurn);
}

} // namespace filasofia::runtime
