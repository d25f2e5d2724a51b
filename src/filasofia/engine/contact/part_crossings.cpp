#include "filasofia/engine/contact/part_crossings.h"

#include "filasofia/engine/collision/surface_crossings.h"
#include "filasofia/engine/contact/intersections.h"
#include "filasofia/engine/contact/may_cross.h"
#include "filasofia/geometry/distance.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

// [-] Relative to both proximities: so deep a contact counts, besides both insets. It decides how fast the surfaces
// part: solids at 60 mm/s at 1 kHz, shells faster. Half as deep, a sheet is not drawn out of another within kPartFor;
// twice as deep, tissue between plates that leave it no room moves twice as fast. Softer contacts part nothing.
constexpr double kDepth = 0.1;
constexpr double kPartFor = 1.0; // [s]
// [-] Below it the way out is rounding: an edge in the middle of a flat part tells nothing.
constexpr double kLeastWay = 1e-3;

/// The edge's number; both vertices are those of an edge.
int edgeBetween(const CollisionShape& shape, const std::array<int, 2>& ends)
{
    const auto edges = shape.vertexEdges[ends[0]];
    return *std::ranges::find_if(edges, [&](int edge) { return shape.edges[edge] == ends; });
}

/// The direction in which the edge moves relative to the triangle, not normalised.
Vec3 wayOut(const SurfaceCrossing& crossing, int edge, const CollisionSurface& own, const CollisionSurface& target)
{
    const Vec3 from = own.x[crossing.edge[0]], along = normalized(own.x[crossing.edge[1]] - from);
    const auto [a, b, c] = crossing.triangle;
    const Vec3 normal = normalized(cross(target.x[b] - target.x[a], target.x[c] - target.x[a]));
    const double rise = dot(along, normal);
    if (rise == 0.0) return {};
    const CollisionShape& shape = *own.shape;
    Vec3 way;
    for (int i = shape.edgeTriangles.start[edge]; i < shape.edgeTriangles.start[edge + 1]; ++i) {
        const Vec3 third = own.x[shape.edgeOpposites[i]] - from;
        const Vec3 inwards = third - dot(third, along) * along; // across the edge, into the triangle
        Vec3 line = normalized(cross(normal, cross(along, inwards)));
        if (dot(line, inwards) < 0.0) line = -line;
        way += line - dot(along, line) / rise * normal;
    }
    return way;
}

class Parting {
public:
    Parting(const StepContext& context, const Scene& scene, const std::vector<SurfaceOwner>& owners,
            ContactDetection& detection)
        : context_(context), scene_(scene), owners_(owners), detection_(detection)
    {
    }

    void part(std::array<int, 2> pair)
    {
        const auto first = static_cast<std::size_t>(pair[0]), second = static_cast<std::size_t>(pair[1]);
        const SurfacePair meeting{{&detection_.surfaces[first], &detection_.surfaces[second]}, pair, 0.0};
        findCrossings(context_, pair, detection_, crossings_);
        eraseHeld(scene_, owners_[first], owners_[second], pair, crossings_);
        if (crossings_.empty()) return;
        dropAtCrossings(meeting);
        for (const SurfaceCrossing& each : crossings_) add(meeting, each);
    }

private:
    /// Surfaces that have passed through each other push where they are near, from whatever side.
    void dropAtCrossings(const SurfacePair& meeting)
    {
        std::array<std::vector<int>, 2> crossing; // vertices per side
        for (const SurfaceCrossing& each : crossings_) {
            const std::size_t side = each.surfaces[0] == meeting.places[0] ? 0 : 1;
            crossing[side].insert(crossing[side].end(), each.edge.begin(), each.edge.end());
            crossing[1 - side].insert(crossing[1 - side].end(), each.triangle.begin(), each.triangle.end());
        }
        if (meeting.self()) {
            crossing[0].insert(crossing[0].end(), crossing[1].begin(), crossing[1].end());
            crossing[1] = crossing[0];
        }
        for (std::vector<int>& each : crossing) std::ranges::sort(each);
        std::erase_if(detection_.proximities, [&](const Proximity& near) {
            if (near.surfaces != meeting.places) return false;
            const auto touches = [&](std::size_t side) {
                return std::ranges::any_of(near.vertices[side], [&](int vertex) {
                    return vertex >= 0 && std::ranges::binary_search(crossing[side], vertex);
                });
            };
            return touches(0) && touches(1);
        });
    }

    void add(const SurfacePair& meeting, const SurfaceCrossing& crossing)
    {
        const std::size_t side = crossing.surfaces[0] == meeting.places[0] ? 0 : 1;
        const CollisionSurface &own = *meeting.sides[side], &target = *meeting.sides[1 - side];
        const int edge = edgeBetween(*own.shape, crossing.edge);
        const Vec3 way = wayOut(crossing, edge, own, target);
        const double size = length(way);
        if (!(size > kLeastWay)) return;
        const auto [a, b, c] = crossing.triangle;
        Proximity& out = detection_.proximities.emplace_back();
        out.surfaces = meeting.places;
        out.vertices[side] = {crossing.edge[0], crossing.edge[1], -1};
        out.weights[side] = {1.0 - crossing.along, crossing.along, 0.0};
        out.vertices[1 - side] = crossing.triangle;
        out.weights[1 - side] =
            geometry::nearestOnTriangle(crossing.place, target.x[a], target.x[b], target.x[c]).weights;
        out.normal = (side == 0 ? 1.0 : -1.0) / size * way;
        out.gap = -kDepth * meeting.proximities();
        out.parting = true;
        const int triangle = *std::ranges::find_if(target.shape->vertexTriangles[a], [&](int t) {
            return target.shape->triangles[static_cast<std::size_t>(t)] == crossing.triangle;
        });
        const int mine = own.shape->edgeFeature(edge), other = target.shape->triangleFeature(triangle);
        out.feature = side == 0 ? featureNumber(meeting, mine, other) : featureNumber(meeting, other, mine);
    }

    const StepContext& context_;
    const Scene& scene_;
    const std::vector<SurfaceOwner>& owners_;
    ContactDetection& detection_;
    std::vector<SurfaceCrossing> crossings_;
};

} // namespace

bool partsFrom(const SurfaceOwner& one, const SurfaceOwner& two, const Scene& scene)
{
    const auto isFree = [&](const SurfaceOwner& each) { return scene.rigid[each.body].model.dynamic; };
    return one.soft == two.soft && (one.soft || (isFree(one) && isFree(two) && one.body != two.body)) &&
           one.collision->shape->triangleFaces && two.collision->shape->triangleFaces;
}

void partCrossings(const StepContext& context, const Scene& scene, const std::vector<SurfaceOwner>& owners,
                   ContactDetection& detection)
{
    const std::vector<IntersectionWatch::Unseen>& lost = detection.intersections.lost;
    if (lost.empty()) return;
    Parting parting(context, scene, owners, detection);
    for (const std::array<int, 2>& pair : detection.scratch.surfacePairs) {
        const SurfaceOwner &one = owners[static_cast<std::size_t>(pair[0])],
                           &two = owners[static_cast<std::size_t>(pair[1])];
        if (!partsFrom(one, two, scene)) continue;
        const auto found =
            std::ranges::find(lost, std::array{one.name, two.name}, &IntersectionWatch::Unseen::surfaces);
        if (found == lost.end() || scene.time - found->since > kPartFor) continue;
        // Crumbs of a torn solid may be stuck in it from several sides, with no way out: they were thrown.
        if (pair[0] != pair[1] || !one.collision->shape->closed) parting.part(pair);
    }
}

} // namespace filasofia::engine
