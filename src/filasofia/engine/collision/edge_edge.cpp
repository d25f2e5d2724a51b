#include "filasofia/engine/collision/edge_edge.h"

#include "filasofia/engine/collision/feature_normals.h"
#include "filasofia/geometry/distance.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

// [-] sine squared below which edges count as parallel and have no crossing: the tests of their end points cover them
constexpr double kParallel = 1e-6;
constexpr double kFlat = 1e-3; // [-] sine: a direction this near to a triangle's plane counts as in the plane

// The places where two lines are nearest to each other: s along u from a, t along v from b.
struct EdgeCrossing {
    double s, t;
    Vec3 between; // from the second to the first
    Vec3 across;  // unit vector, normal to both
};

inline bool crossing(Vec3 a, Vec3 u, Vec3 b, Vec3 v, EdgeCrossing& out)
{
    const Vec3 r = a - b;
    const double uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), ur = dot(u, r), vr = dot(v, r);
    const Vec3 across = cross(u, v);
    const double area = lengthSquared(across);
    if (!(area > kParallel * uu * vv)) return false;
    const double s = uv * vr - ur * vv, t = uu * vr - uv * ur;
    if (!(s > 0.0 && s < area && t > 0.0 && t < area)) return false; // rejects most pairs before any division
    out.s = s / area;
    out.t = t / area;
    if (!(out.s > 0.0 && out.s < 1.0 && out.t > 0.0 && out.t < 1.0)) return false;
    out.between = r + out.s * u - out.t * v;
    out.across = across / std::sqrt(area);
    return true;
}

// Whether this edge's triangles have nothing nearer along `n`, which points from the other edge to this one: no
// triangle leads towards the other edge, and at least one leads away from it (the other may lie across: a board that
// lies on another meets it edge over edge). If both triangles of an edge lie across, the edge is flat and does not
// count. The rim of a sheet may lie flat.
bool clear(const CollisionSurface& surface, int edge, Vec3 n)
{
    const CollisionShape& shape = *surface.shape;
    if (!shape.triangleFaces || shape.edgeTriangles[edge].empty()) return true;
    const Vec3 a = surface.x[shape.edges[edge][0]];
    bool away = rimEdge(shape, edge);
    for (int i = shape.edgeTriangles.start[edge]; i < shape.edgeTriangles.start[edge + 1]; ++i) {
        const Vec3 ao = surface.x[shape.edgeOpposites[i]] - a;
        const double rise = dot(n, ao), flat = kFlat * length(ao);
        if (!(rise >= -flat)) return false;
        away = away || rise > flat;
    }
    // Inside a closed surface this also holds at concave edges; the normal excludes them.
    return away && (!shape.closed || dot(n, edgeNormal(surface, edge)) < 0.0);
}

bool solid(const CollisionSurface& surface, int edge)
{
    return surface.shape->closed && surface.shape->triangleFaces && !surface.shape->edgeTriangles[edge].empty();
}

// +1 or -1: the side of `across` that the first edge's outside is on; 0: the edges do not face each other.
double sideOf(const SurfacePair& meeting, int first, int second, const EdgeCrossing& at)
{
    const CollisionSurface &one = *meeting.sides[0], &two = *meeting.sides[1];
    const double apart = dot(at.between, at.across) >= 0.0 ? 1.0 : -1.0;
    for (const double side : {apart, -apart}) {
        if (clear(one, first, side * at.across) && clear(two, second, -side * at.across)) return side;
        if (!solid(one, first) && !solid(two, second)) return 0.0; // nothing indicates that they have passed each other
    }
    return 0.0;
}

} // namespace

bool nearAtRest(const SurfacePair& meeting, const std::array<int, 3>& a, const std::array<int, 3>& b)
{
    const std::vector<Vec3>& rest = meeting.sides[0]->shape->rest;
    const double nearest = meeting.proximities() * meeting.proximities();
    // A feature with fewer than three vertices is a triangle that repeats a vertex; edge against edge also needs their
    // crossing.
    const auto corner = [&](const std::array<int, 3>& f, int k) { return rest[f[k] >= 0 ? f[k] : f[0]]; };
    const auto anyNear = [&](const std::array<int, 3>& points, const std::array<int, 3>& feature) {
        return std::ranges::any_of(points, [&](int v) {
            return v >= 0 &&
                   geometry::nearestOnTriangle(rest[v], corner(feature, 0), corner(feature, 1), corner(feature, 2))
                           .squaredDistance < nearest;
        });
    };
    if (anyNear(a, b) || anyNear(b, a)) return true;
    EdgeCrossing at;
    if (a[1] < 0 || b[1] < 0 || !crossing(rest[a[0]], rest[a[1]] - rest[a[0]], rest[b[0]], rest[b[1]] - rest[b[0]], at))
        return false;
    return lengthSquared(at.between) < nearest;
}

void collideEdges(const SurfacePair& meeting, int first, int second, std::vector<Proximity>& found)
{
    const CollisionSurface &one = *meeting.sides[0], &two = *meeting.sides[1];
    const auto [a0, a1] = one.shape->edges[first];
    const auto [b0, b1] = two.shape->edges[second];
    if (meeting.self() && (a0 == b0 || a0 == b1 || a1 == b0 || a1 == b1)) return;
    const Bounds boundsA = merged(one.vertexBounds[a0], one.vertexBounds[a1]);
    const Bounds boundsB = merged(two.vertexBounds[b0], two.vertexBounds[b1]);
    if (!meet(boundsA, boundsB)) return;
    EdgeCrossing at;
    if (!crossing(one.x[a0], one.x[a1] - one.x[a0], two.x[b0], two.x[b1] - two.x[b0], at)) return;
    const double far = reachOf(boundsA) + reachOf(boundsB);
    if (!(lengthSquared(at.between) <= far * far)) return;
    const double side = sideOf(meeting, first, second, at);
    if (side == 0.0) return;

    const Vec3 normal = side * at.across;
    const double gap = dot(at.between, normal);
    const Feature onA{{a0, a1, -1}, {1.0 - at.s, at.s, 0.0}, one.shape->edgeFeature(first)};
    const Feature onB{{b0, b1, -1}, {1.0 - at.t, at.t, 0.0}, two.shape->edgeFeature(second)};
    const double leaving = dot(velocityAt(one, onA) - velocityAt(two, onB), normal);
    if (!(gap < meeting.proximities() + meeting.reach * std::max(0.0, -leaving))) return;
    if (meeting.self() && (gap < 0.0 || nearAtRest(meeting, onA.vertices, onB.vertices))) return;
    if (gap < 0.0) {
        // Distant edges on the outsides of two thin bodies look the same: each place must be inside the other body.
        if (gap < -meeting.depths()) return;
        if (solid(two, second) && !inside(two, one.x[a0] + at.s * (one.x[a1] - one.x[a0]), -gap)) return;
        if (solid(one, first) && !inside(one, two.x[b0] + at.t * (two.x[b1] - two.x[b0]), -gap)) return;
    }
    const std::uint64_t number = meeting.self() && onB.number < onA.number
                                     ? featureNumber(meeting, onB.number, onA.number)
                                     : featureNumber(meeting, onA.number, onB.number);
    found.push_back({meeting.places, {onA.vertices, onB.vertices}, {onA.weights, onB.weights}, normal, gap, number});
}

} // namespace filasofia::engine
