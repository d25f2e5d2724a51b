#include "filasofia/testing/surface_overlap.h"

#include "filasofia/geometry/box.h"
#include "filasofia/geometry/distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

namespace filasofia::testing {
namespace {

/// Six times the signed volume of a tetrahedron.
double volume6(Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return dot(b - a, cross(c - a, d - a)); }

struct Corner3 {
    Vec3 a, b, c;
};
Corner3 cornersOf(const PlacedSurface& surface, const geometry::Triangle& t)
{
    const auto at = [&](int v) { return surface.vertices[static_cast<std::size_t>(v)]; };
    return {at(t[0]), at(t[1]), at(t[2])};
}

/// [-] Where an edge passes through a triangle, in (0, 1); none if it does not.
std::optional<double> passes(Vec3 p, Vec3 q, const Corner3& t)
{
    const double from = volume6(t.a, t.b, t.c, p), to = volume6(t.a, t.b, t.c, q);
    if ((from > 0.0) == (to > 0.0)) return std::nullopt;
    const double u = volume6(p, q, t.a, t.b), v = volume6(p, q, t.b, t.c), w = volume6(p, q, t.c, t.a);
    if (!((u > 0.0 && v > 0.0 && w > 0.0) || (u < 0.0 && v < 0.0 && w < 0.0))) return std::nullopt;
    return from / (from - to);
}

double distanceTo(Vec3 p, const PlacedSurface& surface)
{
    double nearest = std::numeric_limits<double>::infinity();
    for (const geometry::Triangle& each : surface.triangles) {
        const Corner3 t = cornersOf(surface, each);
        nearest = std::min(nearest, geometry::nearestOnTriangle(p, t.a, t.b, t.c).squaredDistance);
    }
    return std::sqrt(nearest);
}

/// Whether a closed surface goes around a point: the sum of the solid angles is 4 pi (Van Oosterom and Strackee 1983).
bool isInside(Vec3 p, const PlacedSurface& surface)
{
    double sum = 0.0;
    for (const geometry::Triangle& each : surface.triangles) {
        const Corner3 t = cornersOf(surface, each);
        const Vec3 a = t.a - p, b = t.b - p, c = t.c - p;
        const double la = length(a), lb = length(b), lc = length(c);
        sum += 2.0 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
    }
    return sum > 2.0 * std::numbers::pi;
}

std::vector<std::array<int, 2>> edgesOf(const PlacedSurface& surface)
{
    std::set<std::array<int, 2>> edges;
    for (const geometry::Triangle& t : surface.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
            edges.insert({low, high});
        }
    return {edges.begin(), edges.end()};
}

/// The boxes around triangles, and around all of them.
struct TriangleBoxes {
    std::vector<geometry::Box> each = {};
    geometry::Box whole = {};
};
TriangleBoxes boxesOf(const PlacedSurface& surface)
{
    TriangleBoxes boxes;
    for (const geometry::Triangle& each : surface.triangles) {
        const Corner3 t = cornersOf(surface, each);
        boxes.each.push_back({min(t.a, min(t.b, t.c)), max(t.a, max(t.b, t.c))});
        boxes.whole = geometry::merged(boxes.whole, boxes.each.back());
    }
    return boxes;
}

/// Where an edge passes through a triangle.
struct Pass {
    double at = 0.0; ///< [-] in (0, 1), along the edge
    std::size_t triangle = 0;
};

/// Where an edge passes through a surface, from its first end on.
std::vector<Pass> passesOf(Vec3 p, Vec3 q, const PlacedSurface& surface, const TriangleBoxes& boxes)
{
    std::vector<Pass> found;
    const geometry::Box around{min(p, q), max(p, q)};
    if (!geometry::overlap(around, boxes.whole)) return found;
    for (std::size_t t = 0; t < boxes.each.size(); ++t)
        if (geometry::overlap(around, boxes.each[t]))
            if (const auto at = passes(p, q, cornersOf(surface, surface.triangles[t]))) found.push_back({*at, t});
    std::ranges::sort(found, {}, &Pass::at);
    return found;
}

class Overlap {
public:
    /// Measures the edges of `mine` in `other`.
    void measure(const PlacedSurface& mine, const PlacedSurface& other)
    {
        const TriangleBoxes boxes = boxesOf(other);
        for (const auto& [from, to] : edgesOf(mine)) {
            const Vec3 p = mine.vertices[static_cast<std::size_t>(from)];
            const Vec3 q = mine.vertices[static_cast<std::size_t>(to)];
            const std::vector<Pass> found = passesOf(p, q, other, boxes);
            if (found.empty()) continue;
            if (other.closed)
                noteInside(p, q, found, other);
            else
                noteBeyond(p, q, found, mine, other);
        }
    }
    [[nodiscard]] bool found() const { return found_; }
    [[nodiscard]] const SurfaceOverlap& deepest() const { return deepest_; }
    void add(Vec3 place, double depth)
    {
        if (!found_ || depth > deepest_.depth) deepest_ = {depth, place};
        found_ = true;
    }

private:
    void noteInside(Vec3 p, Vec3 q, const std::vector<Pass>& found, const PlacedSurface& other)
    {
        if (isInside(p, other)) add(p, distanceTo(p, other));
        if (isInside(q, other)) add(q, distanceTo(q, other));
        for (std::size_t k = 0; k + 1 < found.size(); ++k) {
            const Vec3 middle = p + 0.5 * (found[k].at + found[k + 1].at) * (q - p);
            if (isInside(middle, other)) add(middle, distanceTo(middle, other));
        }
    }
    /// An open surface has no inside: whichever end is nearer to it has passed through, unless it is the open surface
    /// that reaches into the other one.
    void noteBeyond(Vec3 p, Vec3 q, const std::vector<Pass>& found, const PlacedSurface& mine,
                    const PlacedSurface& other)
    {
        bool reaches = false;
        for (const Pass& each : found)
            for (const int v : other.triangles[each.triangle])
                if (const Vec3 x = other.vertices[static_cast<std::size_t>(v)]; mine.closed && isInside(x, mine)) {
                    reaches = true;
                    add(x, distanceTo(x, mine));
                }
        if (reaches) return;
        const double one = distanceTo(p, other), two = distanceTo(q, other);
        add(one < two ? p : q, std::min(one, two));
    }

    SurfaceOverlap deepest_;
    bool found_ = false;
};

/// A part of a line between two places where it passes through a surface, or its end.
struct LinePart {
    std::vector<Vec3> points = {};
    double length = 0.0; ///< [m]
};
std::vector<LinePart> partsOf(std::span<const Vec3> line, const PlacedSurface& surface)
{
    const TriangleBoxes boxes = boxesOf(surface);
    std::vector<LinePart> parts{{.points = {line.front()}}};
    const auto goOn = [&](Vec3 to) {
        parts.back().length += distance(parts.back().points.back(), to);
        parts.back().points.push_back(to);
    };
    for (std::size_t i = 1; i < line.size(); ++i) {
        for (const Pass& each : passesOf(line[i - 1], line[i], surface, boxes)) {
            const Vec3 place = line[i - 1] + each.at * (line[i] - line[i - 1]);
            goOn(place);
            parts.push_back({.points = {place}});
        }
        goOn(line[i]);
    }
    return parts;
}

/// The point of a part that is farthest from the surface; between its ends if it has no other.
LineOverlap farthest(const LinePart& part, const PlacedSurface& surface)
{
    LineOverlap out;
    const auto consider = [&](Vec3 p) {
        if (const double far = distanceTo(p, surface); far > out.depth) out = {far, p};
    };
    for (const Vec3 p : part.points) consider(p);
    consider(0.5 * (part.points.front() + part.points[1]));
    return out;
}

} // namespace

std::optional<LineOverlap> overlapOf(std::span<const Vec3> line, const PlacedSurface& surface)
{
    const std::vector<LinePart> parts = partsOf(line, surface);
    LineOverlap deepest;
    if (!surface.closed) {
        for (std::size_t i = 1; i < parts.size(); ++i) {
            const LineOverlap before = farthest(parts[i - 1], surface), after = farthest(parts[i], surface);
            if (std::min(before.depth, after.depth) > deepest.depth)
                deepest = before.depth < after.depth ? before : after;
        }
        return parts.size() > 1 ? std::optional(deepest) : std::nullopt;
    }
    bool any = false;
    for (const LinePart& part : parts) {
        if (!isInside(0.5 * (part.points.front() + part.points[1]), surface)) continue;
        any = true;
        deepest.inside += part.length;
        if (const LineOverlap here = farthest(part, surface); here.depth > deepest.depth)
            deepest = {here.depth, here.place, deepest.inside};
    }
    return any ? std::optional(deepest) : std::nullopt;
}

std::optional<SurfaceOverlap> overlapOf(const PlacedSurface& a, const PlacedSurface& b)
{
    Overlap overlap;
    overlap.measure(a, b);
    overlap.measure(b, a);
    if (!overlap.found()) { // no surface passes through the other: one may lie inside
        for (const auto& [inner, outer] : {std::pair(&a, &b), std::pair(&b, &a)})
            if (outer->closed && isInside(inner->vertices.front(), *outer))
                for (const Vec3 x : inner->vertices) overlap.add(x, distanceTo(x, *outer));
    }
    if (!overlap.found()) return std::nullopt;
    return overlap.deepest();
}

} // namespace filasofia::testing
