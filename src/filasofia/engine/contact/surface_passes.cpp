#include "filasofia/engine/contact/surface_passes.h"

#include "filasofia/engine/collision/element_pairs.h"
#include "filasofia/engine/collision/feature_pass.h"
#include "filasofia/engine/collision/surface_pair.h"
#include "filasofia/geometry/distance.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

constexpr double kTouching = 1e-4; ///< [-] places this near to each other meet, relative to both proximities
constexpr int kPartSize = 256;     ///< pairs of elements: some 10 us

/// One pair of surfaces, or a surface and itself.
class PassesOfPair {
public:
    PassesOfPair(double dt, const SurfacePair& meeting) : dt_(dt), meeting_(meeting) {}

    void test(std::array<int, 2> pair, std::vector<Proximity>& found) const
    {
        const CollisionShape::Element& a = side(0).shape->elements[pair[0]];
        const CollisionShape::Element& b = side(1).shape->elements[pair[1]];
        testPoints(0, a, pair[1], found);
        testPoints(1, b, pair[0], found);
        for (const int first : a.ownEdges)
            for (const int second : b.ownEdges)
                if (first >= 0 && second >= 0) testEdges(first, second, found);
    }

private:
    [[nodiscard]] const CollisionSurface& side(std::size_t k) const { return *meeting_.sides[k]; }

    [[nodiscard]] MovedPoint moved(std::size_t of, int vertex) const
    {
        const Vec3 from = side(of).x[vertex];
        return {from, from + dt_ * side(of).v[vertex]};
    }

    void testPoints(std::size_t source, const CollisionShape::Element& mine, int element,
                    std::vector<Proximity>& found) const
    {
        const CollisionSurface &own = side(source), &target = side(1 - source);
        const CollisionShape::Element& other = target.shape->elements[element];
        if (other.triangle < 0) return;
        for (const int point : mine.ownVertices)
            if (point >= 0 && meet(own.vertexBounds[point], target.elementBounds[element]))
                testPoint(source, point, other.vertices, found);
    }

    void testPoint(std::size_t source, int point, const geometry::Triangle& triangle,
                   std::vector<Proximity>& found) const
    {
        if (meeting_.self() && std::ranges::find(triangle, point) != triangle.end()) return;
        const std::size_t target = 1 - source;
        const auto pass = firstMeeting(
            moved(source, point),
            MovedTriangle{moved(target, triangle[0]), moved(target, triangle[1]), moved(target, triangle[2])},
            kTouching * meeting_.proximities());
        if (!pass) return;
        const auto passed = [&](int edge) { return crosses(source, side(source).shape->edges[edge], triangle); };
        if (std::ranges::any_of(side(source).shape->vertexEdges[point], passed)) return;
        Proximity out;
        out.vertices[source] = {point, -1, -1};
        out.weights[source] = {1.0, 0.0, 0.0};
        out.vertices[target] = triangle;
        out.weights[target] = pass->weights;
        add(out, found);
    }

    void testEdges(int first, int second, std::vector<Proximity>& found) const
    {
        const auto &a = side(0).shape->edges[first], &b = side(1).shape->edges[second];
        if (meeting_.self() && (a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1])) return;
        const auto boundsOf = [&](std::size_t of, const std::array<int, 2>& edge) {
            return merged(side(of).vertexBounds[edge[0]], side(of).vertexBounds[edge[1]]);
        };
        if (!meet(boundsOf(0, a), boundsOf(1, b))) return;
        const auto pass = firstMeeting(MovedEdge{moved(0, a[0]), moved(0, a[1])},
                                       MovedEdge{moved(1, b[0]), moved(1, b[1])}, kTouching * meeting_.proximities());
        if (!pass || passed(0, a, 1, second) || passed(1, b, 0, first)) return;
        Proximity out;
        out.vertices = {{{a[0], a[1], -1}, {b[0], b[1], -1}}};
        out.weights = {{{1.0 - pass->first, pass->first, 0.0}, {1.0 - pass->second, pass->second, 0.0}}};
        add(out, found);
    }

    /// Whether an edge passes through a triangle of the other edge now.
    [[nodiscard]] bool passed(std::size_t own, const std::array<int, 2>& edge, std::size_t target, int other) const
    {
        const CollisionShape& shape = *side(target).shape;
        return std::ranges::any_of(shape.edgeTriangles[other],
                                   [&](int t) { return crosses(own, edge, shape.triangles[t]); });
    }

    /// Whether an edge passes through a triangle of the other side now.
    [[nodiscard]] bool crosses(std::size_t own, const std::array<int, 2>& edge,
                               const geometry::Triangle& triangle) const
    {
        const auto isCorner = [&](int v) { return std::ranges::find(triangle, v) != triangle.end(); };
        if (meeting_.self() && (isCorner(edge[0]) || isCorner(edge[1]))) return false;
        const std::vector<Vec3>& x = side(1 - own).x;
        const Vec3 from = side(own).x[edge[0]], along = side(own).x[edge[1]] - from;
        return geometry::rayTriangle(from, along, x[triangle[0]], x[triangle[1]], x[triangle[2]]) <= 1.0;
    }

    void add(Proximity& pass, std::vector<Proximity>& found) const
    {
        if (meeting_.self() && nearAtRest(meeting_, pass.vertices[0], pass.vertices[1])) return;
        Vec3 between;
        for (std::size_t of = 0; of < 2; ++of)
            for (std::size_t k = 0; k < 3; ++k)
                if (const int vertex = pass.vertices[of][k]; vertex >= 0)
                    between += (of == 0 ? 1.0 : -1.0) * pass.weights[of][k] * side(of).x[vertex];
        pass.surfaces = meeting_.places;
        pass.normal = normalized(between, {0, 0, 1});
        pass.gap = length(between);
        found.push_back(pass);
    }

    double dt_;
    const SurfacePair& meeting_;
};

} // namespace

std::vector<Proximity> findSurfacePasses(double dt, CollisionSurface& one, CollisionSurface& two,
                                         std::array<int, 2> places, ProximityScratch& scratch, WorkerPool& pool)
{
    const SurfacePair meeting{{&one, &two}, places, 0.0};
    const Vec3 drift = driftOf(one);
    const double near = kTouching * meeting.proximities();
    boundMotion(one, dt, drift, near);
    if (!meeting.self()) boundMotion(two, dt, drift, near);
    std::vector<Proximity> out;
    if (!meet(one.whole, two.whole)) return out;
    collectElementPairs(one, two, nullptr, scratch);
    const std::vector<std::array<int, 2>>& elements = scratch.elementPairs;
    const int count = static_cast<int>(elements.size()), parts = (count + kPartSize - 1) / kPartSize;
    std::vector<std::vector<Proximity>> ofPart(static_cast<std::size_t>(parts));
    const PassesOfPair passes(dt, meeting);
    pool.run(parts, [&](int part) {
        const int end = std::min(count, (part + 1) * kPartSize);
        for (int i = part * kPartSize; i < end; ++i)
            passes.test(elements[static_cast<std::size_t>(i)], ofPart[static_cast<std::size_t>(part)]);
    });
    for (const std::vector<Proximity>& found : ofPart) out.insert(out.end(), found.begin(), found.end());
    return out;
}

} // namespace filasofia::engine
