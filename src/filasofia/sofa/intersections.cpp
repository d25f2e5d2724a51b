#include "filasofia/sofa/intersections.h"

#include "filasofia/geometry/distance.h"
#include "filasofia/sofa/near_surface.h"

#include <algorithm>
#include <set>

namespace filasofia::sofaengine {
namespace {

using geometry::Triangle;
using physics::Intersection;

/// A collision surface where it is now.
struct Placed {
    ModelTag tag = {};
    double skin = 0.0;        ///< [m]
    std::vector<Vec3> x = {}; ///< [m]
    std::vector<Triangle> triangles = {};
    std::vector<std::array<int, 2>> edges = {};
    geometry::Bvh tree = {};
};

Vec3 vertexAt(const Placed& surface, int vertex) { return surface.x[static_cast<std::size_t>(vertex)]; }

Placed placed(const CollisionSurface& surface)
{
    Placed out{.tag = surface.tag, .skin = surface.skin, .triangles = surface.triangles};
    for (const auto& each : surface.states->x.getValue()) out.x.push_back(fromSofa(each));
    std::set<std::array<int, 2>> edges;
    std::vector<geometry::Box> boxes;
    for (const Triangle& t : out.triangles) {
        geometry::Box& box = boxes.emplace_back();
        for (std::size_t i = 0; i < 3; ++i) {
            box = geometry::merged(box, vertexAt(out, t[i]));
            edges.insert({std::min(t[i], t[(i + 1) % 3]), std::max(t[i], t[(i + 1) % 3])});
        }
    }
    out.edges.assign(edges.begin(), edges.end());
    out.tree = geometry::Bvh(boxes);
    return out;
}

/// Where an edge passes through a surface.
struct Crossing {
    double part = 0.0;  ///< [-] along the edge
    bool enters = true; ///< seen along the edge
};

std::vector<Crossing> crossingsOf(Vec3 a, Vec3 b, const Placed& faces, std::vector<int>& near)
{
    std::vector<Crossing> crossings;
    faces.tree.overlapping(geometry::merged(geometry::Box{a, a}, b), near);
    for (const int t : near) {
        const auto [i, j, k] = faces.triangles[static_cast<std::size_t>(t)];
        const Vec3 p = vertexAt(faces, i), q = vertexAt(faces, j), r = vertexAt(faces, k);
        const double part = geometry::rayTriangle(a, b - a, p, q, r);
        if (part >= 0.0 && part <= 1.0) crossings.push_back({part, dot(cross(q - p, r - p), b - a) < 0.0});
    }
    std::ranges::sort(crossings, {}, &Crossing::part);
    return crossings;
}

/// Counts edges of one surface that pass through another, and measures how deep they go: at an end inside, or in the
/// middle of what is inside.
void addCrossings(const Placed& edges, const Placed& faces, Intersection& found)
{
    const NearSurface surface(faces.x, faces.triangles);
    std::vector<int> near;
    for (const auto& [first, second] : edges.edges) {
        const Vec3 a = vertexAt(edges, first), b = vertexAt(edges, second);
        const std::vector<Crossing> crossings = crossingsOf(a, b, faces, near);
        found.crossings += crossings.empty() ? 0 : 1;
        const auto measure = [&](double part, double through) {
            const double depth = surface.distance(a + part * (b - a));
            if (depth <= found.depth) return;
            found.depth = depth;
            found.place = a + through * (b - a);
        };
        for (std::size_t c = 0; c < crossings.size(); ++c) {
            const double part = crossings[c].part;
            if (!crossings[c].enters && c == 0) measure(0.0, part);
            if (!crossings[c].enters) continue;
            const bool ends = c + 1 == crossings.size();
            measure(ends ? 1.0 : 0.5 * (part + crossings[c + 1].part), part);
        }
    }
}

/// Whether one surface lies wholly in another.
void addInside(const Placed& inner, const Placed& outer, Intersection& found)
{
    if (found.crossings > 0 || inner.x.empty()) return;
    const geometry::Box box = outer.tree.bounds();
    if (geometry::merged(box, inner.tree.bounds()) != box) return;
    const NearSurface surface(outer.x, outer.triangles);
    if (!surface.has(inner.x.front(), 0.0)) return;
    found.depth = std::max(found.depth, surface.distance(inner.x.front()));
    found.place = inner.x.front();
}

bool isTold(const SofaScene& scene, BodyId id)
{
    const RigidNode* body = findBody(scene.rigid, id);
    return body != nullptr && !body->plan().def.dynamic;
}

bool areTied(const SofaScene& scene, BodyId a, BodyId b)
{
    return std::ranges::any_of(scene.ties, [&](const auto& each) { return each->holds(a) && each->holds(b); });
}

} // namespace

std::vector<Intersection> intersectionsOf(const SofaScene& scene)
{
    std::vector<Placed> surfaces;
    for (const auto& body : scene.soft)
        for (const CollisionSurface& each : body->surfaces()) surfaces.push_back(placed(each));
    for (const auto& body : scene.rigid)
        for (const CollisionSurface& each : body->surfaces()) surfaces.push_back(placed(each));
    std::ranges::stable_sort(surfaces, {}, [](const Placed& each) { return each.tag.body; });
    std::vector<Intersection> all;
    for (std::size_t a = 0; a < surfaces.size(); ++a)
        for (std::size_t b = a + 1; b < surfaces.size(); ++b) {
            const Placed &one = surfaces[a], &two = surfaces[b];
            if (one.tag.body == two.tag.body || !mayMeet(one.tag, two.tag)) continue;
            if (!geometry::overlap(one.tree.bounds(), two.tree.bounds()) || areTied(scene, one.tag.body, two.tag.body))
                continue;
            Intersection found{.first = one.tag.body, .second = two.tag.body};
            addCrossings(one, two, found);
            addCrossings(two, one, found);
            addInside(one, two, found);
            addInside(two, one, found);
            // Surfaces at rest keep their skins: what is less deep is a load that contacts still bear.
            if (!(found.depth > std::max(one.skin, two.skin))) continue;
            if (isTold(scene, one.tag.body) || isTold(scene, two.tag.body))
                found.cause = physics::IntersectionCause::Told;
            all.push_back(found);
        }
    return all;
}

} // namespace filasofia::sofaengine
