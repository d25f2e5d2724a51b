// The tube around a centre line.
#include "filasofia/mapping/map.h"

#include "filasofia/core/assert.h"

#include <cmath>
#include <numbers>

namespace filasofia::mapping {
namespace {

constexpr int kSides = 12;
constexpr int kRings = 4; // per edge of the centre line

/// A point of the curve and its direction.
struct OnCurve {
    Vec3 place, direction;
};

/// The curve through the nodes (Catmull and Rom 1974), at a fraction t of an edge.
OnCurve curveAt(std::span<const Vec3> x, std::size_t edge, double t)
{
    const Vec3 b = x[edge], c = x[edge + 1];
    const Vec3 a = edge > 0 ? x[edge - 1] : b - (c - b), d = edge + 2 < x.size() ? x[edge + 2] : c + (c - b);
    const Vec3 first = 0.5 * (c - a), second = 0.5 * (d - b); // directions at the nodes
    const double t2 = t * t, t3 = t2 * t;
    return {(2 * t3 - 3 * t2 + 1) * b + (t3 - 2 * t2 + t) * first + (3 * t2 - 2 * t3) * c + (t3 - t2) * second,
            normalized((6 * t2 - 6 * t) * (b - c) + (3 * t2 - 4 * t + 1) * first + (3 * t2 - 2 * t) * second,
                       normalized(c - b, {1, 0, 0}))};
}

/// A vector across a direction that is carried along as that turns.
Vec3 carried(Vec3 across, Vec3 direction)
{
    const Vec3 other = std::abs(direction.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    return normalized(across - dot(across, direction) * direction, normalized(cross(direction, other)));
}

/// The vertices of all rings, then the middles of both ends.
void place(std::span<const Vec3> x, double radius, std::span<Vec3> out)
{
    const std::size_t rings = kRings * (x.size() - 1) + 1;
    Vec3 across;
    std::size_t vertex = 0;
    for (std::size_t ring = 0; ring < rings; ++ring) {
        const std::size_t edge = std::min(ring / kRings, x.size() - 2);
        const OnCurve at = curveAt(x, edge, static_cast<double>(ring - kRings * edge) / kRings);
        across = carried(across, at.direction);
        const Vec3 third = cross(at.direction, across);
        for (int side = 0; side < kSides; ++side) {
            const double angle = 2.0 * std::numbers::pi * side / kSides;
            out[vertex++] = at.place + radius * std::cos(angle) * across + radius * std::sin(angle) * third;
        }
    }
    out[vertex++] = x.front();
    out[vertex] = x.back();
}

} // namespace

MappedSurface mapTube(std::span<const Vec3> nodes, double radius)
{
    FILASOFIA_ASSERT(nodes.size() >= 2 && radius > 0.0);
    const int rings = kRings * static_cast<int>(nodes.size() - 1) + 1;
    MappedSurface mapped;
    mapped.map = TubeMap{static_cast<int>(nodes.size()), radius};
    mapped.surface.vertices.resize(static_cast<std::size_t>(rings * kSides + 2));
    place(nodes, radius, mapped.surface.vertices);
    const auto at = [](int ring, int side) { return kSides * ring + side % kSides; };
    for (int ring = 0; ring + 1 < rings; ++ring)
        for (int side = 0; side < kSides; ++side) {
            const int a = at(ring, side), b = at(ring, side + 1), c = at(ring + 1, side), d = at(ring + 1, side + 1);
            mapped.surface.triangles.push_back({a, b, c});
            mapped.surface.triangles.push_back({b, d, c});
        }
    for (int side = 0; side < kSides; ++side) {
        mapped.surface.triangles.push_back({at(0, side + 1), at(0, side), kSides * rings});
        mapped.surface.triangles.push_back({at(rings - 1, side), at(rings - 1, side + 1), kSides * rings + 1});
    }
    return mapped;
}

void apply(const TubeMap& map, const frame::SoftBodyFrame& body, std::span<Vec3> vertices)
{
    place(std::span(body.positions).first(static_cast<std::size_t>(map.nodes)), map.radius, vertices);
}

} // namespace filasofia::mapping
