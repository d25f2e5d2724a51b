#include "filasofia/mapping/outside.h"

#include "filasofia/geometry/distance.h"

#include <algorithm>

namespace filasofia::mapping {
namespace {

constexpr int kMaxWalk = 256; ///< triangles: a longer walk is taken to be going in circles

/// The weights of the point of the triangle's plane that is nearest to p; they sum to 1.
std::array<double, 3> inPlane(Vec3 p, const std::array<Vec3, 3>& corners)
{
    const Vec3 u = corners[1] - corners[0], v = corners[2] - corners[0], w = p - corners[0];
    const Vec3 normal = cross(u, v);
    const double area = lengthSquared(normal);
    if (!(area > 0.0)) return {1.0, 0.0, 0.0};
    const double b = dot(cross(w, v), normal) / area, c = dot(cross(u, w), normal) / area;
    return {1.0 - b - c, b, c};
}

/// The same cyclic order, with the smallest node first.
geometry::Triangle turned(geometry::Triangle nodes)
{
    std::rotate(nodes.begin(), std::ranges::min_element(nodes), nodes.end());
    return nodes;
}

} // namespace

Outside::Outside(const frame::Boundary& boundary) : boundary_(boundary)
{
    for (std::size_t t = 0; t < boundary.triangles.size(); ++t)
        if (boundary.opened[t] == 0) places_.push_back(t);

    struct Edge {
        int from, to, triangle, corner;
        auto operator<=>(const Edge&) const = default;
    };
    std::vector<Edge> edges; // directed as in their triangle
    std::vector<geometry::Box> boxes;
    double sum = 0.0;
    for (int t = 0; t < triangles(); ++t) {
        const Corners places = corners(t);
        boxes.push_back(geometry::boxAround(places));
        sorted_.push_back(turned(of(t)));
        for (int k = 0; k < 3; ++k) {
            edges.push_back({of(t)[(k + 1) % 3], of(t)[(k + 2) % 3], t, k});
            sum += distance(places[(k + 1) % 3], places[(k + 2) % 3]);
        }
    }
    std::ranges::sort(sorted_);
    std::ranges::sort(edges);
    meanEdge_ = edges.empty() ? 0.0 : sum / static_cast<double>(edges.size());
    neighbours_.assign(places_.size(), {-1, -1, -1});
    for (const Edge& edge : edges) {
        const auto back = std::ranges::lower_bound(edges, Edge{edge.to, edge.from, -1, -1});
        if (back != edges.end() && back->from == edge.to && back->to == edge.from)
            neighbours_[edge.triangle][edge.corner] = back->triangle;
    }
    tree_ = geometry::Bvh(boxes);
}

Outside::Corners Outside::corners(int triangle) const
{
    const auto& [a, b, c] = of(triangle);
    return {boundary_.rest[a], boundary_.rest[b], boundary_.rest[c]};
}

geometry::Triangle Outside::nodes(int triangle) const { return turned(of(triangle)); }

bool Outside::has(const geometry::Triangle& nodes) const { return std::ranges::binary_search(sorted_, nodes); }

std::optional<OutsidePlace> Outside::nearest(Vec3 point, double atMost) const
{
    const auto here = [&](int t) {
        const Corners places = corners(t);
        return geometry::nearestOnTriangle(point, places[0], places[1], places[2]);
    };
    const auto found = tree_.nearest(
        point, [&](int t) { return here(t).squaredDistance; }, atMost * atMost);
    if (found.primitive < 0) return std::nullopt;
    return OutsidePlace{found.primitive, here(found.primitive).point};
}

/// A point slightly away from edges and corners, where it would be ambiguous which triangle a point is in.
Vec3 Outside::inwards(const OutsidePlace& place) const
{
    return 0.99 * place.point + 0.01 * mean(corners(place.triangle), {1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0});
}

std::optional<RimEdge> Outside::rimBetween(const OutsidePlace& from, const OutsidePlace& to) const
{
    OutsidePlace here{from.triangle, inwards(from)};
    const Vec3 goal = to.triangle < 0 ? to.point : inwards(to);
    int cameFrom = -1;
    for (int walked = 0; here.triangle != to.triangle && walked < kMaxWalk; ++walked) {
        const Corners places = corners(here.triangle);
        const auto start = inPlane(here.point, places), end = inPlane(goal, places);
        // Leave through the edge that the straight path crosses first. If the path ends inside, as over a crease, leave
        // through the edge that its end is nearest to.
        int out = -1;
        double way = 1.0;
        for (int k = 0; k < 3; ++k) {
            const int next = neighbours_[here.triangle][k];
            if (!(end[k] < 0.0) || (next >= 0 && next == cameFrom)) continue;
            const double met = std::clamp(start[k] / (start[k] - end[k]), 0.0, 1.0);
            if (out < 0 || met < way) {
                out = k;
                way = met;
            }
        }
        for (int k = 0; out < 0 && k < 3; ++k) {
            const auto others = {end[(k + 1) % 3], end[(k + 2) % 3]};
            if (end[k] <= std::min(others)) out = k;
        }
        const int next = neighbours_[here.triangle][out];
        if (next < 0) return RimEdge{here.triangle, {places[(out + 1) % 3], places[(out + 2) % 3]}};
        Vec3 left;
        for (int k = 0; k < 3; ++k) left += (start[k] + way * (end[k] - start[k])) * places[k];
        cameFrom = here.triangle;
        here = {next, left};
    }
    return std::nullopt;
}

void Outside::embed(Vec3 point, int triangle, geometry::Embedding& embedding) const
{
    const auto& [a, b, c] = of(triangle);
    const int behind = boundary_.behind[places_[triangle]];
    const std::vector<Vec3>& rest = boundary_.rest;
    embedding.nodes.push_back({a, b, c, behind});
    embedding.weights.push_back(geometry::barycentric(point, rest[a], rest[b], rest[c], rest[behind]));
}

} // namespace filasofia::mapping
