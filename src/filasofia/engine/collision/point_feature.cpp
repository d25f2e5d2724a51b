#include "filasofia/engine/collision/point_feature.h"

#include "filasofia/engine/collision/feature_normals.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace filasofia::engine {
namespace {

// If the foot of a point is less than this inside a triangle's side (relative to its height), it is on the side; if it
// is less than this inside an end of an edge (relative to its length), it is on the end. So a foot on the line between
// two flat triangles is found once, whatever the rounding.
constexpr double kSide = 1e-9;
constexpr double kAbove = 0.7071; // [-] cosine of 45 degrees
constexpr double kLeading = 0.02; // [-] sine of a degree: how far a surface in use deviates from flat

// The query of one point against one surface.
struct PointQuery {
    const SurfacePair& meeting;
    int source;
    int point;
    Vec3 p;
    double far; // [m] maximum distance
    std::vector<PointMinimum>& found;

    [[nodiscard]] const CollisionSurface& own() const { return *meeting.sides[source]; }
    [[nodiscard]] const CollisionSurface& target() const { return *meeting.sides[1 - source]; }
};

// Whether the surface around p faces `towards`, the direction of the place that was found: nothing around p leads
// there, so the direction is in the cone of p's normals. Without this check, a box that slides over a plane would
// collide with the vertices before it, which are near its lower edge and on a surface that faces upwards. With 30
// degrees instead of one, an edge rounded by the inset still hit them half its radius ahead, and lost up to half of its
// speed.
bool facing(const PointQuery& query, Vec3 towards)
{
    const CollisionSurface& own = query.own();
    const CollisionShape& shape = *own.shape;
    if (!shape.triangleFaces || shape.vertexTriangles[query.point].empty()) return true;
    if (!shape.closed && rimVertex(shape, query.point)) return true;
    const Vec3 normal = vertexNormal(own, query.point);
    if (normal == Vec3{}) return true;
    return (!shape.closed || dot(normal, towards) > 0.0) &&
           std::ranges::all_of(shape.vertexEdges[query.point], [&](int edge) {
               const auto [a, b] = shape.edges[edge];
               const Vec3 leaving = own.x[a == query.point ? b : a] - query.p;
               return dot(leaving, towards) <= (kLeading + query.meeting.turn) * length(leaving);
           });
}

// Adds a minimum. `away` is the unit vector that opens the gap for the point, as the target determines it.
PointMinimum& addMinimum(const PointQuery& query, const Feature& feature, Vec3 away, double gap, bool twoSided)
{
    const SurfacePair& meeting = query.meeting;
    const int vertices = static_cast<int>(query.target().shape->rest.size());
    const Feature point{{query.point, -1, -1}, {1.0, 0.0, 0.0}, query.point};
    const int mine = query.source, other = 1 - mine;
    PointMinimum& out = query.found.emplace_back();
    out.proximity.surfaces = meeting.places;
    out.proximity.vertices[mine] = point.vertices;
    out.proximity.vertices[other] = feature.vertices;
    out.proximity.weights[mine] = point.weights;
    out.proximity.weights[other] = feature.weights;
    out.proximity.normal = mine == 0 ? away : -away;
    out.proximity.gap = gap;
    out.vertexPair = feature.number < vertices;
    const bool swapped = meeting.self() ? out.vertexPair && feature.number < query.point : mine == 1;
    out.proximity.feature = swapped ? featureNumber(meeting, feature.number, query.point)
                                    : featureNumber(meeting, query.point, feature.number);
    out.point = query.point;
    out.source = mine;
    out.distance = std::fabs(gap);
    out.twoSided = twoSided;
    const double leaving = dot(query.own().v[query.point] - velocityAt(query.target(), feature), away);
    out.range = meeting.proximities() + meeting.reach * std::max(0.0, -leaving);
    out.back = meeting.proximities() + meeting.reach * std::max(0.0, leaving);
    out.limit = meeting.depths();
    return out;
}

// Whether the point is the fourth corner of a tetrahedron whose face has the feature. It is before its own face only
// while the tetrahedron is inside out, and elastic forces turn that back. A contact took the point for one that had
// passed through the face since then, and drew it out again.
bool isApex(const PointQuery& query, const Feature& feature)
{
    const CollisionSurface& target = query.target();
    if (target.apexes.empty()) return false;
    return std::ranges::any_of(target.shape->vertexTriangles[feature.vertices[0]], [&](int t) {
        return target.apexes[t] == query.point && std::ranges::all_of(feature.vertices, [&](int vertex) {
                   return vertex < 0 || std::ranges::count(target.shape->triangles[t], vertex) > 0;
               });
    });
}

bool excluded(const PointQuery& query, const Feature& feature)
{
    return query.meeting.self() &&
           (isApex(query, feature) || nearAtRest(query.meeting, {query.point, -1, -1}, feature.vertices));
}

/// Along the line of a rod at a vertex; zero if the vertex is on no line.
Vec3 alongLine(const CollisionSurface& surface, int vertex)
{
    if (!surface.shape->lines || surface.shape->vertexEdges[vertex].empty()) return {};
    const auto [a, b] = surface.shape->edges[*surface.shape->vertexEdges[vertex].begin()];
    return surface.x[b] - surface.x[a];
}

/// The way out for a point that is on a place of the other surface, where neither has an outside: across both of two
/// lines. Two threads that were drawn as a cross in a plane slid along each other for ever with one along an axis.
Vec3 acrossLines(const PointQuery& query, const Feature& feature)
{
    constexpr double kParallel = 1e-6; // [-] sine squared
    const Vec3 own = alongLine(query.own(), query.point), target = alongLine(query.target(), feature.vertices[0]);
    const Vec3 across = cross(own, target); // the opposite if the other side asks
    if (lengthSquared(across) > kParallel * lengthSquared(own) * lengthSquared(target)) return normalized(across);
    const Vec3 along = query.source == 0 ? own : target;
    if (along == Vec3{}) return {0.0, 0.0, 1.0};
    const Vec3 away = normalized(
        cross(along, std::fabs(along.z) < length(along) * kAbove ? Vec3{0.0, 0.0, 1.0} : Vec3{1.0, 0.0, 0.0}));
    return query.source == 0 ? away : -away;
}

// Adds a minimum at `place` on an edge or vertex with the pseudonormal `normal` (0 if it has none).
void addMinimumAt(const PointQuery& query, const Feature& feature, Vec3 place, Vec3 normal, bool rim)
{
    const CollisionShape& shape = *query.target().shape;
    const Vec3 d = query.p - place;
    const double distance = length(d);
    if (!(distance <= query.far) || excluded(query, feature)) return;
    // At the rim of a sheet a point is above it, below it, or beside it; beside it, the point is on no side.
    const bool beside = rim && std::fabs(dot(d, normalized(normal))) < kAbove * distance;
    const bool hasSides = shape.triangleFaces && !beside && normal != Vec3{}, twoSided = hasSides && !shape.closed;
    // So near that the difference of the two places is mostly rounding.
    if (distance < 1e-12 * (1.0 + length(place))) {
        const Vec3 back = normalized(-vertexNormal(query.own(), query.point), acrossLines(query, feature));
        const Vec3 outwards = normalized(normal, back);
        addMinimum(query, feature, outwards, hasSides ? dot(d, outwards) : distance, twoSided);
        return;
    }
    const double sign = hasSides && dot(d, normal) < 0.0 ? -1.0 : 1.0;
    PointMinimum& out = addMinimum(query, feature, sign / distance * d, sign * distance, twoSided);
    if (sign > 0.0 || twoSided) out.facing = facing(query, -1.0 / distance * d);
}

enum class Face { Inside, Beside, TooFar };

Face testFace(const PointQuery& query, int triangle)
{
    const CollisionSurface& target = query.target();
    const auto [ia, ib, ic] = target.shape->triangles[triangle];
    const Vec3 a = target.x[ia], ab = target.x[ib] - a, ac = target.x[ic] - a, ap = query.p - a;
    const Vec3 normal = cross(ab, ac);
    const double whole = lengthSquared(normal);
    const double longest = std::max(lengthSquared(ab), lengthSquared(ac));
    if (!(whole > kSliver * longest * longest)) return Face::Beside;
    const double height = dot(ap, normal); // times twice the area
    if (height * height > query.far * query.far * whole) return Face::TooFar;
    const double wb = dot(normal, cross(ap, ac)) / whole, wc = dot(normal, cross(ab, ap)) / whole;
    const double wa = 1.0 - wb - wc;
    if (!(wa > kSide && wb > kSide && wc > kSide)) return Face::Beside;
    const double area = std::sqrt(whole);
    const Feature face{{ia, ib, ic}, {wa, wb, wc}, target.shape->triangleFeature(triangle)};
    if (!excluded(query, face)) addMinimum(query, face, normal / area, height / area, !target.shape->closed);
    return Face::Inside;
}

// The foot of p along an edge, 0 to 1.
struct Along {
    Vec3 edge;
    double foot;

    [[nodiscard]] bool beforeFirst() const { return !(foot > kSide); }
    [[nodiscard]] bool behindLast() const { return !(foot < 1.0 - kSide); }
};
Along along(const CollisionSurface& surface, int edge, Vec3 p)
{
    const auto [a, b] = surface.shape->edges[edge];
    const Vec3 e = surface.x[b] - surface.x[a];
    const double whole = lengthSquared(e);
    return {e, whole > 0.0 ? dot(p - surface.x[a], e) / whole : std::numeric_limits<double>::quiet_NaN()};
}

// Whether one of the edge's triangles has a place nearer to p than the edge.
bool nearerBeside(const CollisionSurface& surface, int edge, Vec3 p)
{
    const CollisionShape& shape = *surface.shape;
    const auto [ia, ib] = shape.edges[edge];
    const Vec3 a = surface.x[ia], ab = surface.x[ib] - a, ap = p - a;
    for (int i = shape.edgeTriangles.start[edge]; i < shape.edgeTriangles.start[edge + 1]; ++i) {
        const Vec3 ao = surface.x[shape.edgeOpposites[i]] - a, normal = cross(ab, ao);
        const double whole = lengthSquared(normal), longest = std::max(lengthSquared(ab), lengthSquared(ao));
        if (whole > kSliver * longest * longest && dot(normal, cross(ab, ap)) > kSide * whole) return true;
    }
    return false;
}

void testEdge(const PointQuery& query, int edge)
{
    const CollisionSurface& target = query.target();
    const CollisionShape& shape = *target.shape;
    const auto [ia, ib] = shape.edges[edge];
    const Along at = along(target, edge, query.p);
    if (at.beforeFirst() || at.behindLast()) return;
    const double t = at.foot;
    const Vec3 place = target.x[ia] + t * at.edge;
    if (!(lengthSquared(query.p - place) <= query.far * query.far)) return;
    if (shape.triangleFaces && nearerBeside(target, edge, query.p)) return;
    addMinimumAt(query, {{ia, ib, -1}, {1.0 - t, t, 0.0}, shape.edgeFeature(edge)}, place, edgeNormal(target, edge),
                 rimEdge(shape, edge));
}

void testVertex(const PointQuery& query, int vertex)
{
    const CollisionSurface& target = query.target();
    const CollisionShape& shape = *target.shape;
    if (!(lengthSquared(query.p - target.x[vertex]) <= query.far * query.far)) return;
    if (shape.triangleFaces || shape.lines)
        for (const int edge : shape.vertexEdges[vertex]) {
            const Along at = along(target, edge, query.p);
            if (!(shape.edges[edge][0] == vertex ? at.beforeFirst() : at.behindLast())) return;
        }
    addMinimumAt(query, {{vertex, -1, -1}, {1.0, 0.0, 0.0}, vertex}, target.x[vertex], vertexNormal(target, vertex),
                 rimVertex(shape, vertex));
}

} // namespace

void collidePoint(const SurfacePair& meeting, int source, int point, int element, std::vector<PointMinimum>& found)
{
    const CollisionSurface &own = *meeting.sides[source], &target = *meeting.sides[1 - source];
    const CollisionShape& shape = *target.shape;
    const CollisionShape::Element& at = shape.elements[element];
    if (!shape.triangleFaces && !shape.lines && !shape.points) return;
    if (meeting.self() && std::ranges::find(at.vertices, point) != at.vertices.end()) return;
    const double far = reachOf(own.vertexBounds[point]) + reachOf(target.elementBounds[element]);
    const PointQuery query{meeting, source, point, own.x[point], far, found};
    if (shape.triangleFaces && at.triangle >= 0 && testFace(query, at.triangle) != Face::Beside) return;
    if (shape.triangleFaces || shape.lines)
        for (const int edge : at.ownEdges)
            if (edge >= 0) testEdge(query, edge);
    for (const int vertex : at.ownVertices)
        if (vertex >= 0) testVertex(query, vertex);
}

} // namespace filasofia::engine
