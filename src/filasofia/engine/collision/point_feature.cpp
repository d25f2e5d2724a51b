#include "filasofia/engine/collision/feature_normals.h"
#include "filasofia/engine/collision/surface_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace filasofia::engine {
namespace {

// A foot this little inside a triangle's side (of its height) is on the side, and one this little inside an end of an
// edge (of its length) is on the end: so one on the line between two flat triangles is found once, however it is
// rounded.
constexpr double kSide = 1e-9;
constexpr double kSliver = 1e-18; // [-] twice the area squared over the longest side to the fourth: has no face
constexpr double kAbove = 0.7071; // [-] cosine of 45 degrees
constexpr double kLeading = 0.02; // [-] sine of a degree: as far as a flat surface in use is from flat

// What is asked: one point against one surface.
struct Asked {
    const Meeting& meeting;
    int source;
    int point;
    Vec3 p;
    double far; // [m] beyond it nothing counts
    std::vector<PointMinimum>& found;

    [[nodiscard]] const CollisionSurface& own() const { return *meeting.sides[source]; }
    [[nodiscard]] const CollisionSurface& target() const { return *meeting.sides[1 - source]; }
};

// Whether the surface around p looks in direction `towards`, of what p met: nothing around p leads there, so that the
// direction is in the cone of p's normals. Without this a box sliding over a plane would bump into the vertices before
// it, which are near its lower edge and on a surface that looks up. With 30 degrees, as was, an edge rounded by the
// inset still met them half its radius ahead, and lost up to half of its speed.
bool facing(const Asked& asked, Vec3 towards)
{
    const CollisionSurface& own = asked.own();
    const CollisionShape& shape = *own.shape;
    if (!shape.triangleFaces || shape.vertexTriangles[asked.point].empty()) return true;
    if (!shape.closed && rimVertex(shape, asked.point)) return true;
    const Vec3 normal = vertexNormal(own, asked.point);
    if (normal == Vec3{}) return true;
    return (!shape.closed || dot(normal, towards) > 0.0) &&
           std::ranges::all_of(shape.vertexEdges[asked.point], [&](int edge) {
               const auto [a, b] = shape.edges[edge];
               const Vec3 leaving = own.x[a == asked.point ? b : a] - asked.p;
               return dot(leaving, towards) <= kLeading * length(leaving);
           });
}

// Enters a minimum: `away` is the unit vector that opens the gap for the point, as the target tells it.
PointMinimum& enter(const Asked& asked, const Feature& feature, Vec3 away, double gap, bool twoSided)
{
    const Meeting& meeting = asked.meeting;
    const int vertices = static_cast<int>(asked.target().shape->rest.size());
    const Feature point{{asked.point, -1, -1}, {1.0, 0.0, 0.0}, asked.point};
    const int mine = asked.source, other = 1 - mine;
    PointMinimum& out = asked.found.emplace_back();
    out.proximity.surfaces = meeting.places;
    out.proximity.vertices[mine] = point.vertices;
    out.proximity.vertices[other] = feature.vertices;
    out.proximity.weights[mine] = point.weights;
    out.proximity.weights[other] = feature.weights;
    out.proximity.normal = mine == 0 ? away : -away;
    out.proximity.gap = gap;
    out.vertexPair = feature.number < vertices;
    const bool swapped = meeting.self() ? out.vertexPair && feature.number < asked.point : mine == 1;
    out.proximity.feature = swapped ? featureNumber(meeting, feature.number, asked.point)
                                    : featureNumber(meeting, asked.point, feature.number);
    out.point = asked.point;
    out.source = mine;
    out.distance = std::fabs(gap);
    out.twoSided = twoSided;
    const double leaving = dot(asked.own().v[asked.point] - velocityAt(asked.target(), feature), away);
    out.range = meeting.proximities() + meeting.reach * std::max(0.0, -leaving);
    out.back = meeting.proximities() + meeting.reach * std::max(0.0, leaving);
    out.limit = meeting.depths();
    return out;
}

bool excluded(const Asked& asked, const Feature& feature)
{
    return asked.meeting.self() && nearAtRest(asked.meeting, {asked.point, -1, -1}, feature.vertices);
}

// A minimum at `place` on an edge or vertex whose pseudonormal is `normal`: 0 where it has none.
void enterAt(const Asked& asked, const Feature& feature, Vec3 place, Vec3 normal, bool rim)
{
    const CollisionShape& shape = *asked.target().shape;
    const Vec3 d = asked.p - place;
    const double distance = length(d);
    if (!(distance <= asked.far) || excluded(asked, feature)) return;
    // At the rim of a sheet a point may be above or below it, or beside it and on no side.
    const bool beside = rim && std::fabs(dot(d, normalized(normal))) < kAbove * distance;
    const bool hasSides = shape.triangleFaces && !beside && normal != Vec3{}, twoSided = hasSides && !shape.closed;
    // So near that the difference of two places is mostly rounding.
    if (distance < 1e-12 * (1.0 + length(place))) {
        const Vec3 back = normalized(-vertexNormal(asked.own(), asked.point), {0.0, 0.0, 1.0});
        const Vec3 outwards = normalized(normal, back);
        enter(asked, feature, outwards, hasSides ? dot(d, outwards) : distance, twoSided);
        return;
    }
    const double sign = hasSides && dot(d, normal) < 0.0 ? -1.0 : 1.0;
    PointMinimum& out = enter(asked, feature, sign / distance * d, sign * distance, twoSided);
    if (sign > 0.0 || twoSided) out.facing = facing(asked, -1.0 / distance * d);
}

enum class Face { Met, Beside, TooFar };

Face meetFace(const Asked& asked, int triangle)
{
    const CollisionSurface& target = asked.target();
    const auto [ia, ib, ic] = target.shape->triangles[triangle];
    const Vec3 a = target.x[ia], ab = target.x[ib] - a, ac = target.x[ic] - a, ap = asked.p - a;
    const Vec3 normal = cross(ab, ac);
    const double whole = lengthSquared(normal);
    const double longest = std::max(lengthSquared(ab), lengthSquared(ac));
    if (!(whole > kSliver * longest * longest)) return Face::Beside;
    const double height = dot(ap, normal); // times twice the area
    if (height * height > asked.far * asked.far * whole) return Face::TooFar;
    const double wb = dot(normal, cross(ap, ac)) / whole, wc = dot(normal, cross(ab, ap)) / whole;
    const double wa = 1.0 - wb - wc;
    if (!(wa > kSide && wb > kSide && wc > kSide)) return Face::Beside;
    const double area = std::sqrt(whole);
    const Feature face{{ia, ib, ic}, {wa, wb, wc}, target.shape->triangleFeature(triangle)};
    if (!excluded(asked, face)) enter(asked, face, normal / area, height / area, !target.shape->closed);
    return Face::Met;
}

// How far along an edge the foot of p is, 0 to 1.
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

// Whether one of the edge's triangles has something nearer to p than the edge.
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

void meetEdge(const Asked& asked, int edge)
{
    const CollisionSurface& target = asked.target();
    const CollisionShape& shape = *target.shape;
    const auto [ia, ib] = shape.edges[edge];
    const Along at = along(target, edge, asked.p);
    if (at.beforeFirst() || at.behindLast()) return;
    const double t = at.foot;
    const Vec3 place = target.x[ia] + t * at.edge;
    if (!(lengthSquared(asked.p - place) <= asked.far * asked.far)) return;
    if (shape.triangleFaces && nearerBeside(target, edge, asked.p)) return;
    enterAt(asked, {{ia, ib, -1}, {1.0 - t, t, 0.0}, shape.edgeFeature(edge)}, place, edgeNormal(target, edge),
            rimEdge(shape, edge));
}

void meetVertex(const Asked& asked, int vertex)
{
    const CollisionSurface& target = asked.target();
    const CollisionShape& shape = *target.shape;
    if (!(lengthSquared(asked.p - target.x[vertex]) <= asked.far * asked.far)) return;
    if (shape.triangleFaces || shape.lines)
        for (const int edge : shape.vertexEdges[vertex]) {
            const Along at = along(target, edge, asked.p);
            if (!(shape.edges[edge][0] == vertex ? at.beforeFirst() : at.behindLast())) return;
        }
    enterAt(asked, {{vertex, -1, -1}, {1.0, 0.0, 0.0}, vertex}, target.x[vertex], vertexNormal(target, vertex),
            rimVertex(shape, vertex));
}

} // namespace

void meetPoint(const Meeting& meeting, int source, int point, int element, std::vector<PointMinimum>& found)
{
    const CollisionSurface &own = *meeting.sides[source], &target = *meeting.sides[1 - source];
    const CollisionShape& shape = *target.shape;
    const CollisionShape::Element& at = shape.elements[element];
    if (!shape.triangleFaces && !shape.lines && !shape.points) return;
    if (meeting.self() && std::ranges::find(at.vertices, point) != at.vertices.end()) return;
    const double far = reachOf(own.vertexBounds[point]) + reachOf(target.elementBounds[element]);
    const Asked asked{meeting, source, point, own.x[point], far, found};
    if (shape.triangleFaces && at.triangle >= 0 && meetFace(asked, at.triangle) != Face::Beside) return;
    if (shape.triangleFaces || shape.lines)
        for (const int edge : at.ownEdges)
            if (edge >= 0) meetEdge(asked, edge);
    for (const int vertex : at.ownVertices)
        if (vertex >= 0) meetVertex(asked, vertex);
}

} // namespace filasofia::engine
