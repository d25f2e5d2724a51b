#include "filasofia/mapping/printed_sheet.h"

#include "filasofia/geometry/distance.h"

#include <limits>

namespace filasofia::mapping {

void PrintedSheet::print(MappedSurface& surface)
{
    const std::vector<int>& nodes = std::get<IdentityMap>(surface.map).nodes;
    surface.surface.uv.clear();
    for (std::size_t v = 0; v < nodes.size(); ++v) {
        const auto node = static_cast<std::size_t>(nodes[v]);
        const Vec3 place = surface.surface.vertices[v];
        if (node >= known_.size()) known_.resize(node + 1);
        Known& known = known_[node];
        if (!known.there || known.place != place) {
            const bool old = node < rest_.vertices.size() && rest_.vertices[node] == place;
            known = {place, old ? rest_.uv[node] : at(place), true};
        }
        surface.surface.uv.push_back(known.uv);
    }
}

std::array<double, 2> PrintedSheet::at(Vec3 place) const
{
    std::array<double, 2> out{};
    double nearest = std::numeric_limits<double>::infinity();
    for (const geometry::Triangle& t : rest_.triangles) {
        const auto corner = [&](std::size_t k) { return static_cast<std::size_t>(t[k]); };
        const auto found = geometry::nearestOnTriangle(place, rest_.vertices[corner(0)], rest_.vertices[corner(1)],
                                                       rest_.vertices[corner(2)]);
        if (const double far = found.squaredDistance; far < nearest) {
            nearest = far;
            out = {};
            for (std::size_t k = 0; k < 3; ++k)
                for (std::size_t i = 0; i < 2; ++i) out[i] += found.weights[k] * rest_.uv[corner(k)][i];
        }
    }
    return out;
}

} // namespace filasofia::mapping
