#include "filasofia/engine/collision/edge_edge.h"

#include "filasofia/engine/collision/feature_normals.h"
#include "filasofia/geometry/distance.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

// [-] sine squared below which edges count as parallel and have no crossing: the tests of their end points cover them
constexpr double kParallel = 1e-6;
constexpr double kRounded = 1e-12; // [m] rounding, of edges that touch
constexpr double kFlat = 1e-3;     // [-] sine: a direction this near to a triangle's plane counts as in the plane
// [-] Sines, for an edge of tissue that is bent over another edge. Many of its neighbours cross that edge at nearly the
// same distance. If only the nearest counted, others would count in each step: tissue between two jaws that stood still
// shook at 50 to 150 mm/s for ever, at 20 iterations per step. If also those count that lead towards the other edge by
// kNearly, or are flat while the other is kSharp, it rests, at 2 to 5 iterations.
constexpr double kNearly = 0.1, kSharp = 0.3;
// [-] Edges of tissue that pushed each other in the last step count until one leads towards the other by more than
// this, also if it has become flat. Surfaces that are pressed together are flat within kFlat: their edges counted and
// did not count in turn, and what one had borne fell on its neighbours at once. Two organs that a plate pressed with
// 20 N then took 12 iterations a step for ever, 30 in each eighth step; now 0.5. What slides past by more than kPast of
// both proximities in a step and a half is at other edges anyway.
constexpr double kStillNearly = 0.15, kPast = 0.3;
constexpr double kWall = 1e-3;   // [-] least thickness of a wall relative to the proximities
constexpr double kFacing = 0.5;  // [-] cosine of the angle between outsides that face each other at rest, at most
constexpr double kPressed = 0.3; // [-] these only count if they are this near, relative to both proximities and insets

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

// How the triangles of an edge lie along `n`, which points from the other edge to this one.
struct EdgeSlopes {
    bool faces = true;    // no triangle leads towards the other edge by more than kStillNearly; the surface faces it
    double lowest = 1.0;  // [-] sine of the angle of the triangle that leads towards the other edge most, or away least
    double highest = 0.0; // [-] for the triangle that leads away most
    bool rim = true;

    // At least one triangle leads away from the other edge (the other one may lie across: a board that lies on another
    // meets it edge over edge). If both lie across, the edge is flat. The rim of a sheet may lie flat.
    [[nodiscard]] bool away() const { return rim || highest > kFlat; }
    // No triangle leads towards the other edge by more than kNearly.
    [[nodiscard]] bool nearly() const { return lowest >= -kNearly; }
    // No triangle leads towards the other edge, or will do so only once the surfaces have turned.
    [[nodiscard]] bool clear(double turn) const { return lowest >= -kFlat - turn && away(); }
};

EdgeSlopes slopesOf(const CollisionSurface& surface, int edge, Vec3 n, double turn)
{
    const CollisionShape& shape = *surface.shape;
    EdgeSlopes slopes;
    if (!shape.triangleFaces || shape.edgeTriangles[edge].empty()) return slopes;
    slopes.rim = rimEdge(shape, edge);
    const Vec3 a = surface.x[shape.edges[edge][0]];
    for (int i = shape.edgeTriangles.start[edge]; i < shape.edgeTriangles.start[edge + 1]; ++i) {
        const Vec3 ao = surface.x[shape.edgeOpposites[i]] - a;
        const double slope = dot(n, ao) / length(ao);
        if (!(slope >= -std::max(kStillNearly, kFlat + turn))) return {.faces = false};
        slopes.lowest = std::min(slopes.lowest, slope);
        slopes.highest = std::max(slopes.highest, slope);
    }
    // Inside a closed surface all this also holds at concave edges; the normal excludes them.
    slopes.faces = !shape.closed || dot(n, edgeNormal(surface, edge)) < 0.0;
    return slopes;
}

// Whether one of the edge's triangles leads away from the other edge by more than kSharp: the sine of the angle of the
// triangle itself, as the opposite vertex of a long edge may lie far along it.
bool sharp(const CollisionSurface& surface, int edge, Vec3 n)
{
    const CollisionShape& shape = *surface.shape;
    if (!shape.triangleFaces) return false;
    const Vec3 a = surface.x[shape.edges[edge][0]], along = surface.x[shape.edges[edge][1]] - a;
    for (int i = shape.edgeTriangles.start[edge]; i < shape.edgeTriangles.start[edge + 1]; ++i) {
        const Vec3 ao = surface.x[shape.edgeOpposites[i]] - a;
        if (dot(n, ao) * length(along) / length(cross(along, ao)) > kSharp) return true;
    }
    return false;
}

/// Whether some place on an edge from `c` to `d` is on the outer side of an edge through `a` with the normal `n`.
bool mayBeBefore(Vec3 a, Vec3 n, Vec3 c, Vec3 d) { return std::max(dot(n, c - a), dot(n, d - a)) > -kRounded; }

bool solid(const CollisionSurface& surface, int edge)
{
    return surface.shape->closed && surface.shape->triangleFaces && !surface.shape->edgeTriangles[edge].empty();
}

// How two edges face each other.
struct Facing {
    double side = 0.0;    // +1 or -1: the side of `across` that the first edge's outside is on; 0: they do not
    bool nearest = false; // this place is nearer than all others around it, or was
};

// Whether two edges, of which one is tissue, pushed each other in the last step and are still at this place.
bool stay(const SurfacePair& meeting, int first, int second, const EdgeCrossing& at)
{
    const CollisionSurface &one = *meeting.sides[0], &two = *meeting.sides[1];
    const auto velocity = [](const CollisionSurface& surface, int edge, double part) {
        const auto [a, b] = surface.shape->edges[edge];
        return (1.0 - part) * surface.v[a] + part * surface.v[b];
    };
    const Vec3 passing = velocity(one, first, at.s) - velocity(two, second, at.t);
    const Vec3 past = meeting.reach * (passing - dot(passing, at.across) * at.across);
    return length(past) < kPast * meeting.proximities() && edgesPushed(meeting, first, second);
}

Facing facingOf(const SurfacePair& meeting, int first, int second, const EdgeCrossing& at)
{
    const CollisionSurface &one = *meeting.sides[0], &two = *meeting.sides[1];
    // Lines that cross in a point have the side that the tests of their vertices choose (point_feature.cpp).
    const double apart = dot(at.between, at.across) >= -kRounded ? 1.0 : -1.0;
    const bool bends = one.element < 0 || two.element < 0; // one of them is tissue
    // Neither is a thread: around a cylinder that is a polygon it stayed at corners that it had left, and the forces at
    // its ends were off by 4.9 % in place of 1.2 % (720 degrees).
    const bool flat = !one.shape->triangles.empty() && !two.shape->triangles.empty();
    for (const double side : {apart, -apart}) {
        const Vec3 toOne = side * at.across, toTwo = -toOne;
        const EdgeSlopes a = slopesOf(one, first, toOne, meeting.turn);
        if (a.faces) {
            const EdgeSlopes b = slopesOf(two, second, toTwo, meeting.turn);
            if (b.faces && a.clear(meeting.turn) && b.clear(meeting.turn)) return {side, true};
            if (b.faces && bends && a.nearly() && b.nearly() &&
                ((a.away() && b.away()) || sharp(one, first, toOne) || sharp(two, second, toTwo)))
                return {side, false};
            if (b.faces && bends && flat && stay(meeting, first, second, at)) return {side, true};
        }
        if (!solid(one, first) && !solid(two, second)) return {}; // nothing indicates that they have passed each other
    }
    return {};
}

// Whether visit(n) is true of the normal at rest, as long as twice its area, of some triangle that has all vertices of
// a feature.
template <class Visit>
bool anyNormalAtRest(const CollisionShape& shape, const std::array<int, 3>& feature, const Visit& visit)
{
    for (const int t : shape.vertexTriangles[feature[0]]) {
        const geometry::Triangle& corners = shape.triangles[t];
        const auto has = [&](int v) { return v < 0 || std::ranges::find(corners, v) != corners.end(); };
        if (!has(feature[1]) || !has(feature[2])) continue;
        const Vec3 a = shape.rest[corners[0]];
        if (visit(cross(shape.rest[corners[1]] - a, shape.rest[corners[2]] - a))) return true;
    }
    return false;
}

// Whether the outsides of two features face each other at rest. The two sides of a wall do not: each is behind the
// other. The lips of a cut lie in one plane. `thick` [m]: how much a wall is thicker than rounding.
bool faceEachOther(const CollisionShape& shape, const std::array<int, 3>& a, const std::array<int, 3>& b, double thick)
{
    const Vec3 between = shape.rest[b[0]] - shape.rest[a[0]];
    return anyNormalAtRest(shape, a, [&](Vec3 n) {
        if (shape.sheet && !(dot(n, between) > 0.0)) return false;
        const bool behind = dot(n, between) < -thick * length(n);
        return anyNormalAtRest(shape, b, [&](Vec3 m) {
            const double along = dot(n, m);
            return along < 0.0 && along * along > kFacing * kFacing * lengthSquared(n) * lengthSquared(m) &&
                   !(behind && dot(m, between) > thick * length(m));
        });
    });
}

} // namespace

bool nearAtRest(const SurfacePair& meeting, const std::array<int, 3>& a, const std::array<int, 3>& b)
{
    // Where a cut has parted a solid its pieces lie against each other, and may be pressed together again.
    const std::vector<int>& pieceOf = meeting.sides[0]->pieceOf;
    if (!pieceOf.empty() && meeting.sides[0]->shape->closed && pieceOf[a[0]] != pieceOf[b[0]]) return false;
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
    const auto areNear = [&] {
        if (anyNear(a, b) || anyNear(b, a)) return true;
        EdgeCrossing at;
        return a[1] >= 0 && b[1] >= 0 &&
               crossing(rest[a[0]], rest[a[1]] - rest[a[0]], rest[b[0]], rest[b[1]] - rest[b[0]], at) &&
               lengthSquared(at.between) < nearest;
    };
    const CollisionShape& shape = *meeting.sides[0]->shape;
    return areNear() && !((shape.closed || shape.sheet) && faceEachOther(shape, a, b, kWall * meeting.proximities()));
}

void collideEdges(const SurfacePair& meeting, int first, int second, std::vector<Proximity>& found)
{
    const CollisionSurface &one = *meeting.sides[0], &two = *meeting.sides[1];
    const auto [a0, a1] = one.shape->edges[first];
    const auto [b0, b1] = two.shape->edges[second];
    if (meeting.self() && (a0 == b0 || a0 == b1 || a1 == b0 || a1 == b1)) return;
    if (meeting.edgeNormals != nullptr &&
        !(mayBeBefore(one.x[a0], (*meeting.edgeNormals)[first], one.x[b0], one.x[b1]) &&
          mayBeBefore(one.x[b0], (*meeting.edgeNormals)[second], one.x[a0], one.x[a1])))
        return; // only with a gap below 0, which does not count here
    const Bounds boundsA = merged(one.vertexBounds[a0], one.vertexBounds[a1]);
    const Bounds boundsB = merged(two.vertexBounds[b0], two.vertexBounds[b1]);
    if (!meet(boundsA, boundsB)) return;
    EdgeCrossing at;
    if (!crossing(one.x[a0], one.x[a1] - one.x[a0], two.x[b0], two.x[b1] - two.x[b0], at)) return;
    const double far = reachOf(boundsA) + reachOf(boundsB);
    if (!(lengthSquared(at.between) <= far * far)) return;
    const Facing facing = facingOf(meeting, first, second, at);
    if (facing.side == 0.0) return;

    const Vec3 normal = facing.side * at.across;
    const double gap = dot(at.between, normal);
    const Feature onA{{a0, a1, -1}, {1.0 - at.s, at.s, 0.0}, one.shape->edgeFeature(first)};
    const Feature onB{{b0, b1, -1}, {1.0 - at.t, at.t, 0.0}, two.shape->edgeFeature(second)};
    const double leaving = dot(velocityAt(one, onA) - velocityAt(two, onB), normal);
    const double range = (facing.nearest ? 1.0 : kPressed) * meeting.proximities();
    if (!(gap < range + meeting.reach * std::max(0.0, -leaving))) return;
    if (meeting.self() && (gap < 0.0 || nearAtRest(meeting, onA.vertices, onB.vertices))) return;
    if (gap < 0.0) {
        // Distant edges on the outsides of two thin bodies look the same: each place must be inside the other body.
        if (gap < -meeting.depths()) return;
        if (solid(two, second) && !inside(two, one.x[a0] + at.s * (one.x[a1] - one.x[a0]), -gap)) return;
        if (solid(one, first) && !inside(one, two.x[b0] + at.t * (two.x[b1] - two.x[b0]), -gap)) return;
    }
    found.push_back({meeting.places,
                     {onA.vertices, onB.vertices},
                     {onA.weights, onB.weights},
                     normal,
                     gap,
                     edgesNumber(meeting, first, second)});
}

} // namespace filasofia::engine
