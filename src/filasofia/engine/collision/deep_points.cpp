#include "filasofia/engine/collision/deep_points.h"

#include "filasofia/engine/collision/feature_normals.h"
#include "filasofia/geometry/box.h"

#include <algorithm>

namespace filasofia::engine {

void findDeepPoints(const SurfacePair& meeting, int source, std::vector<Proximity>& found)
{
    const CollisionSurface &own = *meeting.sides[source], &target = *meeting.sides[1 - source];
    if (meeting.self() || !own.shape->points || !target.shape->closed || !target.shape->triangleFaces) return;
    const double size = sizeOf(target);
    for (const CollisionShape::Element& element : own.shape->elements)
        for (const int point : element.ownVertices) {
            if (point < 0 || damaged(own.vertexBounds[point]) || !meet(own.vertexBounds[point], target.whole)) continue;
            const NearestOnSurface nearest = nearestOn(target, own.x[point], size);
            if (nearest.triangle < 0) continue;
            const Vec3 out = nearest.place - own.x[point];
            const double depth = length(out);
            if (!(depth > meeting.depths()) || !(dot(out, nearest.normal) > 0.0)) continue;
            Proximity& deep = found.emplace_back();
            deep.surfaces = meeting.places;
            deep.vertices[source] = {point, -1, -1};
            deep.weights[source] = {1.0, 0.0, 0.0};
            deep.vertices[1 - source] = target.shape->triangles[nearest.triangle];
            deep.weights[1 - source] = nearest.weights;
            deep.normal = (source == 0 ? 1.0 : -1.0) / depth * out;
            deep.gap = -depth;
            const int face = target.shape->triangleFeature(nearest.triangle);
            deep.feature = source == 0 ? featureNumber(meeting, point, face) : featureNumber(meeting, face, point);
        }
}

bool overlapDeep(const SurfacePair& meeting)
{
    const auto hasInside = [](const CollisionSurface* side) {
        return side->shape->closed && side->shape->triangleFaces;
    };
    if (meeting.self() || !std::ranges::all_of(meeting.sides, hasInside)) return false;
    const double deeper = 1.01 * meeting.depths(); // than that, with a margin for rounding
    for (const int side : {0, 1}) {
        const CollisionSurface &own = *meeting.sides[side], &other = *meeting.sides[1 - side];
        const geometry::Box around = geometry::boxAround(other.x);
        for (std::size_t t = 0; t < own.shape->triangles.size(); ++t) {
            const auto& [a, b, c] = own.shape->triangles[t];
            const Vec3 middle = 1.0 / 3.0 * (own.x[a] + own.x[b] + own.x[c]);
            const Vec3 below = middle - deeper * normalized(faceNormal(own, static_cast<int>(t)));
            if (geometry::contains(around, below) && depthInside(other, below) > meeting.depths() &&
                depthInside(own, below) > meeting.depths())
                return true;
        }
    }
    return false;
}

} // namespace filasofia::engine
