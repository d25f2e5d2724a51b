#include "filasofia/engine/collision/surface_crossings.h"

#include "filasofia/engine/collision/element_pairs.h"
#include "filasofia/engine/collision/feature_normals.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>
#include <utility>

namespace filasofia::engine {
namespace {

constexpr int kCrossingsPerPart = 512; // pairs of elements
constexpr double kOpposite = -0.5; // cosine between the faces by which an edge enters and leaves a wall, not a corner

/// Whether a triangle's plane has all of the other element, a triangle, a line or a point, on one side.
bool planeSeparates(const CollisionSurface& a, const std::array<int, 3>& triangle, const CollisionSurface& b,
                    const std::array<int, 3>& other)
{
    const Vec3 at = a.x[triangle[0]];
    const Vec3 normal = cross(a.x[triangle[1]] - at, a.x[triangle[2]] - at);
    const auto height = [&](int vertex) { return dot(normal, b.x[vertex] - at); };
    const double h0 = height(other[0]), h1 = other[1] < 0 ? h0 : height(other[1]),
                 h2 = other[2] < 0 ? h1 : height(other[2]);
    return std::min(h0, std::min(h1, h2)) > 0.0 || std::max(h0, std::max(h1, h2)) < 0.0;
}

bool sharesVertex(const std::array<int, 2>& edge, const geometry::Triangle& triangle)
{
    return std::ranges::any_of(edge, [&](int v) { return std::ranges::find(triangle, v) != triangle.end(); });
}

/// Tests the edges that element `mine` of side `source` owns against a triangle of the other side.
void crossTriangle(const SurfacePair& meeting, int source, const CollisionShape::Element& mine,
                   const geometry::Triangle& triangle, std::vector<SurfaceCrossing>& found)
{
    const CollisionSurface &own = *meeting.sides[source], &target = *meeting.sides[1 - source];
    const Vec3 corners[] = {target.x[triangle[0]], target.x[triangle[1]], target.x[triangle[2]]};
    const Vec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double area = length(normal);
    for (const int e : mine.ownEdges) {
        if (e < 0) continue;
        const std::array<int, 2>& edge = own.shape->edges[e];
        const Vec3 from = own.x[edge[0]], to = own.x[edge[1]];
        const double h0 = dot(normal, from - corners[0]), h1 = dot(normal, to - corners[0]);
        if (!((h0 < 0.0) != (h1 < 0.0))) continue;
        const double along = h0 / (h0 - h1);
        const Vec3 place = from + along * (to - from);
        bool within = true;
        for (std::size_t k = 0; k < 3; ++k)
            within = within && dot(normal, cross(corners[(k + 1) % 3] - corners[k], place - corners[k])) >= 0.0;
        if (!within) continue;
        if (meeting.self() && (sharesVertex(edge, triangle) || nearAtRest(meeting, {edge[0], edge[1], -1}, triangle)))
            continue;
        found.push_back({{meeting.places[source], meeting.places[1 - source]},
                         edge,
                         triangle,
                         along,
                         place,
                         std::min(std::fabs(h0), std::fabs(h1)) / area});
    }
}

void crossElements(const SurfacePair& meeting, std::array<int, 2> pair, std::vector<SurfaceCrossing>& found)
{
    const CollisionSurface &one = *meeting.sides[0], &two = *meeting.sides[1];
    const CollisionShape::Element &a = one.shape->elements[pair[0]], &b = two.shape->elements[pair[1]];
    const bool faceA = a.triangle >= 0 && one.shape->triangleFaces, faceB = b.triangle >= 0 && two.shape->triangleFaces;
    // Two triangles meet only if each crosses the plane of the other.
    if ((faceA && planeSeparates(one, a.vertices, two, b.vertices)) ||
        (faceB && planeSeparates(two, b.vertices, one, a.vertices)))
        return;
    if (faceB) crossTriangle(meeting, 0, a, b.vertices, found);
    // A surface against itself: both elements are of the first side, and so are their edges.
    const SurfacePair turned{{meeting.sides[1], meeting.sides[0]}, {meeting.places[1], meeting.places[0]}, 0.0};
    if (faceA) crossTriangle(turned, 0, b, a.vertices, found);
}

Vec3 normalOf(const CollisionSurface& surface, const geometry::Triangle& triangle)
{
    const Vec3 at = surface.x[triangle[0]];
    return normalized(cross(surface.x[triangle[1]] - at, surface.x[triangle[2]] - at));
}

/// [m] How deep a line goes on to be beyond a vertex of it that is inside, until it crosses the closed surface or ends.
/// Its edges may be far shorter than it is deep.
double depthBeyond(const CollisionSurface& line, const CollisionSurface& closed, std::array<int, 2> from,
                   std::span<const SurfaceCrossing> all)
{
    auto [last, vertex] = from;
    double depth = 0.0;
    for (std::size_t count = line.shape->edges.size(); count > 0; --count) {
        int next = -1;
        for (const int e : line.shape->vertexEdges[static_cast<std::size_t>(vertex)]) {
            const std::array<int, 2>& edge = line.shape->edges[static_cast<std::size_t>(e)];
            const int other = edge[0] == vertex ? edge[1] : edge[0];
            const bool crosses = std::ranges::find(all, edge, &SurfaceCrossing::edge) != all.end();
            if (other != last && !crosses) next = other;
        }
        if (next < 0) break;
        depth = std::max(depth, depthInside(closed, line.x[static_cast<std::size_t>(next)]));
        last = std::exchange(vertex, next);
    }
    return depth;
}

/// The crossings of one edge, ascending along it: what a plane tells of its depth would be far too much for a long edge
/// that only grazes a corner.
void measureDepths(const CollisionSurface& own, const CollisionSurface& closed, std::span<SurfaceCrossing> ofEdge,
                   std::span<const SurfaceCrossing> all)
{
    const std::array<int, 2> edge = ofEdge.front().edge;
    const auto depthAtEnd = [&](int last, int vertex) {
        const double depth = depthInside(closed, own.x[vertex]);
        return depth > 0.0 && own.shape->triangles.empty()
                   ? std::max(depth, depthBeyond(own, closed, {last, vertex}, all))
                   : depth;
    };
    const Vec3 from = own.x[edge[0]], to = own.x[edge[1]];
    const auto depthAt = [&](double along) { return depthInside(closed, from + along * (to - from)); };
    for (std::size_t i = 0; i < ofEdge.size(); ++i) {
        const double low = i == 0 ? 0.0 : ofEdge[i - 1].along,
                     high = i + 1 == ofEdge.size() ? 1.0 : ofEdge[i + 1].along;
        const double at = ofEdge[i].along;
        double depth = std::max(depthAt(0.5 * (low + at)), depthAt(0.5 * (at + high)));
        if (low == 0.0) depth = std::max(depth, depthAtEnd(edge[1], edge[0]));
        if (high == 1.0) depth = std::max(depth, depthAtEnd(edge[0], edge[1]));
        ofEdge[i].depth = depth;
        if (i == 0) continue;
        const Vec3 in = normalOf(closed, ofEdge[i - 1].triangle), out = normalOf(closed, ofEdge[i].triangle);
        if (dot(in, to - from) < 0.0 && dot(out, to - from) > 0.0 && dot(in, out) < kOpposite)
            ofEdge[i - 1].through = ofEdge[i].through = true;
    }
}

/// Completes the crossings of a pair: what passes through a sheet is through it, what enters a closed surface is
/// measured.
void measure(const SurfacePair& meeting, std::vector<SurfaceCrossing>& crossings)
{
    const auto keyOf = [](const SurfaceCrossing& each) { return std::tuple(each.surfaces, each.edge, each.along); };
    std::ranges::sort(crossings, {}, keyOf);
    for (std::size_t i = 0; i < crossings.size();) {
        std::size_t end = i + 1;
        while (end < crossings.size() && crossings[end].surfaces == crossings[i].surfaces &&
               crossings[end].edge == crossings[i].edge)
            ++end;
        const std::span ofEdge = std::span(crossings).subspan(i, end - i);
        const int side = crossings[i].surfaces[0] == meeting.places[0] ? 0 : 1;
        const CollisionSurface& target = *meeting.sides[1 - side];
        if (!target.shape->closed)
            for (SurfaceCrossing& each : ofEdge) each.through = true;
        else if (!meeting.self())
            measureDepths(*meeting.sides[side], target, ofEdge, crossings);
        i = end;
    }
}

} // namespace

void findSurfaceCrossings(const SurfacePair& meeting, WorkerPool& pool, ProximityScratch& scratch,
                          std::vector<SurfaceCrossing>& found)
{
    const auto hasFaces = [](const CollisionSurface* side) { return side->shape->triangleFaces; };
    if (std::ranges::none_of(meeting.sides, hasFaces)) return;
    collectElementPairs(*meeting.sides[0], *meeting.sides[1], nullptr, scratch);
    const int pairs = static_cast<int>(scratch.elementPairs.size()),
              parts = (pairs + kCrossingsPerPart - 1) / kCrossingsPerPart;
    std::vector<std::vector<SurfaceCrossing>> ofPart(static_cast<std::size_t>(parts));
    pool.run(parts, [&](int i) {
        const int end = std::min(pairs, (i + 1) * kCrossingsPerPart);
        for (int k = i * kCrossingsPerPart; k < end; ++k)
            crossElements(meeting, scratch.elementPairs[k], ofPart[static_cast<std::size_t>(i)]);
    });
    std::vector<SurfaceCrossing> all;
    for (const std::vector<SurfaceCrossing>& part : ofPart) all.insert(all.end(), part.begin(), part.end());
    measure(meeting, all);
    found.insert(found.end(), all.begin(), all.end());
}

} // namespace filasofia::engine
