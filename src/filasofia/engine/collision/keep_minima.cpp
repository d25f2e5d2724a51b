#include "filasofia/engine/collision/keep_minima.h"

#include "filasofia/engine/collision/feature_normals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace filasofia::engine {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

template <class Visit> void forEachMinimum(ProximityScratch& scratch, const Visit& visit)
{
    for (std::size_t i = 0; i < scratch.partsUsed; ++i)
        for (PointMinimum& minimum : scratch.parts[i].points) visit(minimum);
}

struct KnownSide {
    int side = 0;      ///< 1 or -1; 0: it was not near
    bool same = false; ///< relative to this very place
};

// The side on which the point was relative to this place, or to the one that shares most vertices with it. In a crease
// of a solid, a place on one wall may share a vertex with one on the other: if two share as many, the point was behind.
// In a sheet it makes no difference which of the two decides.
KnownSide sideBefore(const std::vector<SheetSide>& sides, const SheetSide& now)
{
    const auto key = [](const SheetSide& kept) { return std::tie(kept.source, kept.target, kept.point); };
    const auto before = [&](const SheetSide& a, const SheetSide& b) { return key(a) < key(b); };
    std::ptrdiff_t most = 0;
    int side = 0;
    bool same = false;
    for (auto it = std::ranges::lower_bound(sides, now, before); it != sides.end() && key(*it) == key(now); ++it) {
        const std::ptrdiff_t shared = std::ranges::count_if(it->feature, [&](int vertex) {
            return vertex >= 0 && std::ranges::find(now.feature, vertex) != now.feature.end();
        });
        same = same || it->feature == now.feature;
        if (shared > most || (shared == most && shared > 0 && it->side < side)) {
            most = shared;
            side = it->side;
        }
    }
    return {side, same};
}

SheetSide sideNow(const SurfacePair& meeting, const PointMinimum& m)
{
    return {meeting.sides[m.source]->name, meeting.sides[1 - m.source]->name, m.point,
            m.proximity.vertices[1 - m.source]};
}

// Leaves out the places of a point's own surface that it is behind, and was not outside of before: the other walls of
// thin parts.
void leaveOutOtherWalls(const SurfacePair& meeting, const std::vector<SheetSide>& sides, ProximityScratch& scratch)
{
    forEachMinimum(scratch, [&](PointMinimum& m) {
        if (m.proximity.gap < 0.0 && sideBefore(sides, sideNow(meeting, m)).side <= 0) m.distance = kNone;
    });
}

/// Whether the surface around the point nowhere looks at a face that it is outside of: its own tissue is there.
bool hasOwnBelow(const CollisionSurface& surface, const PointMinimum& m)
{
    return m.proximity.gap >= 0.0 && m.proximity.vertices[1 - m.source][2] >= 0 &&
           std::ranges::all_of(surface.shape->vertexTriangles[m.point],
                               [&](int t) { return dot(faceNormal(surface, t), m.proximity.normal) > 0.0; });
}

// Faces of a point's own surface that its tissue has passed through do not hold it, if they were through each other
// when the surface was first seen to meet itself: a vessel that a clip had pressed through itself before a cut let it
// collide with itself stayed shut for good.
void leaveOutPassed(const SurfacePair& meeting, const std::vector<SheetSide>& sides, ProximityScratch& scratch)
{
    const SurfaceName& name = meeting.sides[0]->name;
    const bool first =
        std::ranges::none_of(sides, [&](const SheetSide& kept) { return kept.source == name && kept.target == name; });
    forEachMinimum(scratch, [&](PointMinimum& m) {
        if (!hasOwnBelow(*meeting.sides[m.source], m)) return;
        const int side = sideBefore(sides, sideNow(meeting, m)).side;
        m.passed = side < 0 || (first && side == 0);
        if (m.passed) m.facing = false;
    });
}

// Finds the signed distance of the nearest place for each point: below 0 if the point is inside. Entries are reset for
// all points with a minimum before any is compared.
void findNearest(ProximityScratch& scratch)
{
    forEachMinimum(scratch, [&](const PointMinimum& m) {
        std::vector<double>& nearest = scratch.nearest[m.source];
        if (nearest.size() <= static_cast<std::size_t>(m.point)) nearest.resize(static_cast<std::size_t>(m.point) + 1);
        nearest[m.point] = kNone;
    });
    forEachMinimum(scratch, [&](const PointMinimum& m) {
        double& nearest = scratch.nearest[m.source][m.point];
        if (m.distance < std::fabs(nearest)) nearest = m.proximity.gap;
    });
}

// For a closed surface: outside, every near place counts; inside, only the nearest way out.
bool keepForSolid(PointMinimum& m, double nearest)
{
    if (nearest < 0.0) return m.proximity.gap == nearest && m.distance <= m.limit;
    return m.proximity.gap >= 0.0 && m.proximity.gap < m.range && m.facing;
}

/// Whether a point of a solid would be drawn out of its solid, along its outside, to a side of a sheet. Where cloth
/// slides down a ball its folds pass the ball's vertices, and one had the side that was known of another fold: two
/// contacts pressed the cloth into the ball with 19 N, six times its weight, for good.
bool drawnOut(const SurfacePair& meeting, const PointMinimum& m)
{
    constexpr double kAlong = 0.2; // [-] cosine; a corner of a box has 0.58 to its faces
    const CollisionSurface& own = *meeting.sides[m.source];
    if (!own.shape->closed || !own.shape->triangleFaces) return false;
    const Vec3 away = m.source == 0 ? m.proximity.normal : -m.proximity.normal;
    return dot(away, normalized(vertexNormal(own, m.point))) > kAlong;
}

// For a sheet.
bool keepForSheet(const SurfacePair& meeting, const std::vector<SheetSide>& sides, ProximityScratch& scratch,
                  PointMinimum& m)
{
    SheetSide now = sideNow(meeting, m);
    const KnownSide known = sideBefore(sides, now);
    int side = known.side;
    if (side == 0) side = m.proximity.gap < 0.0 ? -1 : 1;
    if (side < 0) {
        m.proximity.gap = -m.proximity.gap;
        m.proximity.normal = -m.proximity.normal;
    }
    const double gap = m.proximity.gap;
    if (gap < 0.0 && !known.same && !meeting.self() && drawnOut(meeting, m)) return false;
    if (gap < 0.0 ? -gap > m.limit : !(gap < (side < 0 ? m.back : m.range) && m.facing)) return false;
    now.side = side;
    scratch.nextSides.push_back(now);
    return true;
}

// For a solid against itself: notes where a point is outside, and where it is behind another wall. If only the former
// were known, it would count as pressed through the other wall as soon as it was near both: bodies with narrow creases
// deformed at rest, by a tenth of their size.
void keepSide(const SurfacePair& meeting, ProximityScratch& scratch, const PointMinimum& m)
{
    const bool behind = m.distance == kNone && scratch.nearest[m.source][m.point] != kNone;
    if (!m.kept && !behind && !m.passed) return;
    scratch.nextSides.push_back(sideNow(meeting, m));
    if (!m.kept) scratch.nextSides.back().side = -1;
}

// Two vertices find each other from both sides. The second side's minimum counts only if the first side has not found
// it. If one surface has no triangles, the one with triangles decides, as it knows better which way is out.
bool secondary(const SurfacePair& meeting, const PointMinimum& m)
{
    if (!m.vertexPair) return false;
    if (meeting.self()) return m.point > m.proximity.vertices[1 - m.source][0];
    const bool own = meeting.sides[m.source]->shape->triangleFaces;
    const bool target = meeting.sides[1 - m.source]->shape->triangleFaces;
    return own == target ? m.source == 1 : own;
}

} // namespace

void keepMinima(const SurfacePair& meeting, const std::vector<SheetSide>& sides, ProximityScratch& scratch,
                std::vector<Proximity>& found)
{
    if (meeting.ownSolid()) {
        leaveOutOtherWalls(meeting, sides, scratch);
        leaveOutPassed(meeting, sides, scratch);
    }
    findNearest(scratch);
    scratch.vertexPairs.clear();
    forEachMinimum(scratch, [&](PointMinimum& m) {
        const CollisionShape& target = *meeting.sides[1 - m.source]->shape;
        const bool solid = target.closed && target.triangleFaces;
        m.kept = solid        ? keepForSolid(m, scratch.nearest[m.source][m.point])
                 : m.twoSided ? keepForSheet(meeting, sides, scratch, m)
                              : m.proximity.gap < m.range && m.facing;
        if (meeting.ownSolid()) keepSide(meeting, scratch, m);
        if (m.kept && m.vertexPair && !secondary(meeting, m)) scratch.vertexPairs.push_back(m.proximity.feature);
    });
    std::ranges::sort(scratch.vertexPairs);
    for (std::size_t i = 0; i < scratch.partsUsed; ++i) {
        const ProximityScratch::Part& part = scratch.parts[i];
        for (const PointMinimum& m : part.points)
            if (m.kept &&
                !(secondary(meeting, m) && std::ranges::binary_search(scratch.vertexPairs, m.proximity.feature)))
                found.push_back(m.proximity);
        found.insert(found.end(), part.edges.begin(), part.edges.end());
    }
}

} // namespace filasofia::engine
