// The tube around a centre line.
#include "filasofia/mapping/map.h"

#include "filasofia/core/assert.h"

#include <algorithm>
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

/// The centre line of a rod or, if it is `closed`, of a ring.
struct Line {
    std::span<const Vec3> x;
    bool closed = false;
    std::span<const int> cut = {};        ///< edges that are gone, ascending
    std::span<const Vec3> directors = {}; ///< per edge, across it; empty: those that are carried along the line

    [[nodiscard]] bool isCut(std::size_t edge) const
    {
        return !cut.empty() && std::ranges::binary_search(cut, static_cast<int>(edge % edges()));
    }
    /// Whether there is an edge before another one, and it is not cut.
    [[nodiscard]] bool goesOnBefore(std::size_t edge) const
    {
        return (edge > 0 || closed) && !isCut(edge + edges() - 1);
    }
    [[nodiscard]] bool goesOnBehind(std::size_t edge) const
    {
        return (edge + 1 < edges() || closed) && !isCut(edge + 1);
    }
    /// Whether a node has lost all of its edges.
    [[nodiscard]] bool isLone(std::size_t node) const
    {
        return !cut.empty() && !goesOnBefore(node) && (node >= edges() || isCut(node));
    }

    [[nodiscard]] std::size_t edges() const { return closed ? x.size() : x.size() - 1; }
    [[nodiscard]] Vec3 at(std::size_t node) const { return x[node % x.size()]; }
};

/// A place along the line: a fraction t of an edge.
struct Along {
    std::size_t edge = 0;
    double t = 0.0;
};

/// The curve through the nodes (Catmull and Rom 1974).
OnCurve curveAt(const Line& line, Along along)
{
    const auto [edge, t] = along;
    const std::size_t count = line.x.size();
    const Vec3 b = line.at(edge), c = line.at(edge + 1);
    const Vec3 a = line.goesOnBefore(edge) ? line.at(edge + count - 1) : b - (c - b);
    const Vec3 d = line.goesOnBehind(edge) ? line.at(edge + 2) : c + (c - b);
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

Along ringAt(const Line& line, std::size_t ring)
{
    const std::size_t edge = std::min(ring / kRings, line.edges() - 1);
    // The first ring of a cut edge is the end of the edge before it.
    if (ring == kRings * edge && line.isCut(edge) && line.goesOnBefore(edge))
        return {(edge + line.edges() - 1) % line.edges(), 1.0};
    return {edge, static_cast<double>(ring - kRings * edge) / kRings};
}

/// The material's director there, of any length: each edge has its own in its middle.
Vec3 directorAt(const Line& line, Along at)
{
    const std::size_t edges = line.edges();
    const bool before = at.t < 0.5;
    if (!(before ? line.goesOnBefore(at.edge) : line.goesOnBehind(at.edge))) return line.directors[at.edge];
    const Vec3 next = line.directors[(before ? at.edge + edges - 1 : at.edge + 1) % edges];
    return line.directors[at.edge] + std::abs(at.t - 0.5) * (next - line.directors[at.edge]);
}

/// [rad] by how much a vector that is carried around a ring has turned about it when it is back: the rings of vertices
/// turn back evenly.
double turnAround(const Line& line)
{
    if (!line.closed || !line.directors.empty()) return 0.0;
    const std::size_t rings = kRings * line.edges();
    const auto curveOf = [&](std::size_t ring) { return curveAt(line, ringAt(line, ring)); };
    const OnCurve first = curveOf(0);
    const Vec3 start = carried({}, first.direction);
    Vec3 across = start;
    for (std::size_t ring = 1; ring <= rings; ++ring) across = carried(across, curveOf(ring).direction);
    return std::atan2(dot(cross(start, across), first.direction), dot(start, across));
}

/// The vertices of all rings, then the middles of both ends.
void place(const Line& line, double radius, std::span<Vec3> out)
{
    const std::size_t rings = kRings * line.edges() + (line.closed ? 0 : 1);
    const double back = turnAround(line) / static_cast<double>(rings);
    Vec3 across;
    std::size_t vertex = 0;
    for (std::size_t ring = 0; ring < rings; ++ring) {
        const Along along = ringAt(line, ring);
        const OnCurve at = curveAt(line, along);
        across = carried(line.directors.empty() ? across : directorAt(line, along), at.direction);
        const std::size_t edge = ring / kRings, part = ring % kRings;
        if (part > 0 ? line.isCut(edge) : line.isLone(edge)) {
            // The rings within a gap shrink to the middles of its ends and close them; between the two is nothing.
            const Vec3 middle = line.at(2 * part <= kRings ? edge : edge + 1);
            for (int side = 0; side < kSides; ++side) out[vertex++] = middle;
            continue;
        }
        const Vec3 third = cross(at.direction, across);
        for (int side = 0; side < kSides; ++side) {
            const double angle = 2.0 * std::numbers::pi * side / kSides - back * static_cast<double>(ring);
            out[vertex++] = at.place + radius * std::cos(angle) * across + radius * std::sin(angle) * third;
        }
    }
    if (line.closed) return;
    out[vertex++] = line.x.front();
    out[vertex] = line.x.back();
}

/// Where the vertices are while the rod is straight along x and its directors along y.
std::vector<Vec3> straight(const Line& line, double radius, std::size_t vertices)
{
    std::vector<Vec3> out;
    out.reserve(vertices);
    double before = 0.0; // the edges before this one
    for (std::size_t edge = 0; edge < line.edges(); ++edge) {
        const double edgeLength = distance(line.at(edge), line.at(edge + 1));
        const int rings = !line.closed && edge + 1 == line.edges() ? kRings + 1 : kRings;
        for (int ring = 0; ring < rings; ++ring)
            for (int side = 0; side < kSides; ++side) {
                const double angle = 2.0 * std::numbers::pi * side / kSides;
                out.push_back(
                    {before + edgeLength * ring / kRings, radius * std::cos(angle), radius * std::sin(angle)});
            }
        before += edgeLength;
    }
    if (line.closed) return out; // between its last ring and the first the pattern is squeezed
    out.push_back({});
    out.push_back({before, 0, 0});
    return out;
}

} // namespace

MappedSurface mapTube(std::span<const Vec3> nodes, double radius, bool closed)
{
    FILASOFIA_ASSERT(nodes.size() >= 2 && radius > 0.0);
    const Line line{nodes, closed};
    const int gaps = kRings * static_cast<int>(line.edges()), rings = closed ? gaps : gaps + 1;
    MappedSurface mapped;
    mapped.map = TubeMap{static_cast<int>(nodes.size()), radius, closed};
    mapped.surface.vertices.resize(static_cast<std::size_t>(rings * kSides + (closed ? 0 : 2)));
    place(line, radius, mapped.surface.vertices);
    mapped.pattern = straight(line, radius, mapped.surface.vertices.size());
    const auto at = [&](int ring, int side) { return kSides * (ring % rings) + side % kSides; };
    for (int ring = 0; ring < gaps; ++ring)
        for (int side = 0; side < kSides; ++side) {
            const int a = at(ring, side), b = at(ring, side + 1), c = at(ring + 1, side), d = at(ring + 1, side + 1);
            mapped.surface.triangles.push_back({a, b, c});
            mapped.surface.triangles.push_back({b, d, c});
        }
    for (int side = 0; side < kSides && !closed; ++side) {
        mapped.surface.triangles.push_back({at(0, side + 1), at(0, side), kSides * rings});
        mapped.surface.triangles.push_back({at(rings - 1, side), at(rings - 1, side + 1), kSides * rings + 1});
    }
    return mapped;
}

void apply(const TubeMap& map, const frame::SoftBodyFrame& body, std::span<Vec3> vertices)
{
    place({std::span(body.positions).first(static_cast<std::size_t>(map.nodes)), map.closed, body.cutEdges,
           body.directors},
          map.radius, vertices);
}

} // namespace filasofia::mapping
