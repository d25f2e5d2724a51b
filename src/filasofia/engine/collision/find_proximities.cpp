#include "filasofia/engine/collision/find_proximities.h"

#include "filasofia/core/assert.h"
#include "filasofia/engine/collision/edge_edge.h"
#include "filasofia/engine/collision/element_pairs.h"
#include "filasofia/engine/collision/feature_normals.h"
#include "filasofia/engine/collision/keep_minima.h"
#include "filasofia/engine/collision/point_feature.h"
#include "filasofia/engine/collision/surface_pair.h"

#include <algorithm>
#include <utility>

namespace filasofia::engine {
namespace {

constexpr int kPartSize = 64;     // pairs of elements: some 10 µs
constexpr double kMostTurn = 0.5; // [rad]
constexpr double kDrift =
    0.1; // [-] how far a body moves as a whole, relative to the depth, so that its boxes are made anew

bool movesRelativeTo(const CollisionSurface& a, const CollisionSurface& b) // both on one body
{
    const bool soft = a.element < 0;
    return soft || (a.element != b.element && a.element != b.parent && a.parent != b.element);
}

bool collideWithin(const CollisionSurface& a, const CollisionSurface& b) // both on one body
{
    return (&a == &b ? a.self : a.shape->self && b.shape->self) && movesRelativeTo(a, b);
}

bool isPartner(const CollisionSurface& surface, const CollisionSurface& of)
{
    return of.shape->partners == Partners::All || (of.shape->partners == Partners::Soft) == (surface.element < 0);
}

void findEdgeNormals(const CollisionSurface& surface, std::vector<Vec3>& normals)
{
    normals.resize(surface.shape->edges.size());
    for (std::size_t i = 0; i < normals.size(); ++i) normals[i] = edgeNormal(surface, static_cast<int>(i));
}

double turnWithin(double reach, const CollisionSurface& a, const CollisionSurface& b)
{
    if (a.element < 0 || b.element < 0) return 0.0;
    return std::min(kMostTurn, reach * length(a.spin - b.spin));
}

// Tests the boxes around all vertices first: most surfaces are near no other, and need no tree.
void collectSurfacePairs(std::vector<CollisionSurface>& surfaces, double reach, WorkerPool& pool,
                         ProximityScratch& scratch)
{
    const int count = static_cast<int>(surfaces.size());
    pool.run(count, [&](int i) { boundVertices(surfaces[i], reach, surfaces[i].shape->depth); });
    scratch.surfacePairs.clear();
    scratch.wanted.assign(surfaces.size(), 0);
    for (int i = 0; i < count; ++i)
        for (int k = i; k < count; ++k)
            if (mayCollide(surfaces[i], surfaces[k]) && meet(surfaces[i].whole, surfaces[k].whole)) {
                scratch.surfacePairs.push_back({i, k});
                scratch.wanted[i] = scratch.wanted[k] = 1;
            }
    pool.run(count, [&](int i) {
        const auto at = static_cast<std::size_t>(i);
        if (scratch.wanted[at] == 0) return;
        boundTree(surfaces[at]);
        makePlates(surfaces[at]);
    });
}

void testPoints(const SurfacePair& meeting, int source, int mine, int other, std::vector<PointMinimum>& out)
{
    const CollisionSurface &own = *meeting.sides[source], &target = *meeting.sides[1 - source];
    if (!own.shape->points) return;
    for (const int point : own.shape->elements[mine].ownVertices)
        if (point >= 0 && meet(own.vertexBounds[point], target.elementBounds[other]))
            collidePoint(meeting, source, point, other, out);
}

bool farApart(const SurfacePair& meeting, std::array<int, 2> pair)
{
    const CollisionSurface &one = *meeting.sides[0], &two = *meeting.sides[1];
    const double far = reachOf(one.elementBounds[pair[0]]) + reachOf(two.elementBounds[pair[1]]);
    return farApart(one.plates[pair[0]], two.plates[pair[1]], static_cast<float>(far) * (1.0f + 0x1p-20f));
}

// Threads meet flat edges: without, forces around a cylinder were off by 1.5 and 3.2 % (90 and 180 degrees), in place
// of 0.5 and 0.6.
bool isFlatFor(const CollisionShape& other, const CollisionShape& shape, int edge)
{
    return shape.flat(edge) && !other.triangles.empty();
}

// Every feature is tested where its owner is. If a surface is tested against itself, its points always stand on the
// first side.
void testElements(const SurfacePair& meeting, std::array<int, 2> pair, ProximityScratch::Part& out)
{
    if (farApart(meeting, pair)) return;
    testPoints(meeting, 0, pair[0], pair[1], out.points);
    testPoints(meeting, meeting.self() ? 0 : 1, pair[1], pair[0], out.points);
    const CollisionShape &one = *meeting.sides[0]->shape, &two = *meeting.sides[1]->shape;
    if (!one.lines || !two.lines) return;
    const Bounds& other = meeting.sides[1]->elementBounds[pair[1]];
    for (const int a : one.elements[pair[0]].ownEdges) {
        if (a < 0 || isFlatFor(two, one, a)) continue;
        const std::vector<Bounds>& at = meeting.sides[0]->vertexBounds;
        if (!meet(merged(at[one.edges[a][0]], at[one.edges[a][1]]), other)) continue;
        for (const int b : two.elements[pair[1]].ownEdges)
            if (b >= 0 && !isFlatFor(one, two, b)) collideEdges(meeting, a, b, out.edges);
    }
}

void testElementPairs(const SurfacePair& meeting, WorkerPool& pool, ProximityScratch& scratch)
{
    const int pairs = static_cast<int>(scratch.elementPairs.size());
    const int parts = (pairs + kPartSize - 1) / kPartSize;
    if (scratch.parts.size() < static_cast<std::size_t>(parts)) scratch.parts.resize(static_cast<std::size_t>(parts));
    scratch.partsUsed = static_cast<std::size_t>(parts);
    for (int i = 0; i < parts; ++i) scratch.parts[i].points.clear(), scratch.parts[i].edges.clear();
    pool.run(parts, [&](int i) {
        const int end = std::min(pairs, (i + 1) * kPartSize);
        for (int k = i * kPartSize; k < end; ++k) testElements(meeting, scratch.elementPairs[k], scratch.parts[i]);
    });
}

std::span<const PushedFeatures> pushedBetween(std::span<const PushedFeatures> all, BodyId first, BodyId second)
{
    // Not std::ranges::equal_range, whose result clang 14 cannot make of g++'s library.
    struct ByBodies {
        using Pair = std::pair<BodyId, BodyId>;
        static Pair of(const PushedFeatures& each) { return {each.first, each.second}; }
        bool operator()(const PushedFeatures& one, const Pair& other) const { return of(one) < other; }
        bool operator()(const Pair& one, const PushedFeatures& other) const { return one < of(other); }
    };
    const auto [begin, end] = std::equal_range(all.begin(), all.end(), std::pair(first, second), ByBodies());
    return {begin, end};
}

void checkSizes(const std::vector<CollisionSurface>& surfaces)
{
    for (const CollisionSurface& surface : surfaces) {
        FILASOFIA_ASSERT(surface.shape != nullptr);
        const CollisionShape& shape = *surface.shape;
        FILASOFIA_ASSERT(surface.name.model >= 0 && static_cast<std::size_t>(surface.name.model) < kMaxModels);
        FILASOFIA_ASSERT(shape.rest.size() + shape.edges.size() + shape.triangles.size() <= kMaxFeatures);
    }
}

} // namespace

bool mayCollide(const CollisionSurface& a, const CollisionSurface& b)
{
    if (a.shape->nodes.empty() || b.shape->nodes.empty() || !isPartner(a, b) || !isPartner(b, a)) return false;
    if ((a.cuts && b.cuttable) || (b.cuts && a.cuttable)) return false; // a blade passes through
    return a.shape->group == b.shape->group && (a.name.body != b.name.body || collideWithin(a, b));
}

Vec3 driftOf(const CollisionSurface& surface)
{
    Vec3 sum;
    for (const Vec3& v : surface.v)
        if (isFinite(v)) sum += v;
    return 1.0 / static_cast<double>(surface.v.size()) * sum;
}

void findProximities(std::vector<CollisionSurface>& surfaces, double dt, WorkerPool& pool,
                     std::span<const PushedFeatures> pushed, std::vector<SheetSide>& sides, ProximityScratch& scratch,
                     std::vector<Proximity>& found)
{
    checkSizes(surfaces);
    found.clear();
    const double reach = kStepsAhead * dt;
    collectSurfacePairs(surfaces, reach, pool, scratch);
    scratch.nextSides.clear();
    for (const auto& [i, k] : scratch.surfacePairs) {
        SurfacePair meeting{{&surfaces[i], &surfaces[k]}, {i, k}, reach, turnWithin(reach, surfaces[i], surfaces[k])};
        meeting.pushed = pushedBetween(pushed, surfaces[i].name.body, surfaces[k].name.body);
        // Nothing of a body comes nearer to the rest of it because it moves as a whole. A bunny of 10,000 tetrahedra
        // with `self` that fell at 2 m/s took 11 ms a step.
        const Vec3 drift = meeting.self() ? driftOf(surfaces[i]) : Vec3{};
        const CollisionShape& shape = *surfaces[i].shape;
        const bool narrower =
            meeting.self() && (length(drift) * reach > kDrift * shape.depth || shape.ownDepth() < shape.depth);
        if (narrower) boundAgainstItself(surfaces[i], reach, drift);
        // Nor does a piece that has come off and flies away come nearer to itself. A strip of 1,565 tetrahedra, half of
        // which fell at 10 m/s, took 15 ms a step.
        scratch.ownPiece.elements.clear();
        if (meeting.self())
            boundPieces(surfaces[i], reach, narrower ? shape.ownDepth() : shape.depth, narrower ? drift : Vec3{},
                        kDrift * shape.depth, scratch.ownPiece);
        const bool folds = meeting.self() && surfaces[i].shape->triangleFaces;
        if (folds) boundNormals(surfaces[i], scratch.normals);
        if (meeting.ownSolid()) {
            findEdgeNormals(surfaces[i], scratch.edgeNormals);
            meeting.edgeNormals = &scratch.edgeNormals;
            makeRestPlates(surfaces[i]);
        }
        collectElementPairs(surfaces[i], surfaces[k], folds ? &scratch.normals : nullptr, scratch,
                            scratch.ownPiece.elements);
        testElementPairs(meeting, pool, scratch);
        keepMinima(meeting, sides, scratch, found);
        if (narrower) boundSurface(surfaces[i], reach);
    }
    std::ranges::sort(scratch.nextSides);
    std::swap(sides, scratch.nextSides);
}

double closingSpeed(const std::vector<CollisionSurface>& surfaces, const Proximity& found)
{
    Vec3 velocity;
    for (std::size_t side = 0; side < 2; ++side)
        for (std::size_t k = 0; k < 3; ++k)
            if (const int vertex = found.vertices[side][k]; vertex >= 0)
                velocity +=
                    (side == 0 ? 1.0 : -1.0) * found.weights[side][k] *
                    surfaces[static_cast<std::size_t>(found.surfaces[side])].v[static_cast<std::size_t>(vertex)];
    return -dot(velocity, found.normal);
}

} // namespace filasofia::engine
