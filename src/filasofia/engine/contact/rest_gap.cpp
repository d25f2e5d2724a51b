#include "filasofia/engine/contact/rest_gap.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

/// The vertices at rest, moved inwards as those of a step are: computed once per shape, if asked for.
const std::vector<Vec3>& insetAtRest(const CollisionModel& collision, CollisionSurface& surface,
                                     std::vector<Vec3>& normals)
{
    if (surface.restOf != collision.shape) {
        surface.rest = collision.shape->rest;
        applyInset(*collision.shape, collision.inset, normals, surface.rest);
        surface.restOf = collision.shape;
    }
    return surface.rest;
}

} // namespace

double nearerAtRest(const SurfaceOwner& owner, const Proximity& found, double skin, CollisionSurface& surface,
                    std::vector<Vec3>& normals)
{
    const std::vector<Vec3>& rest = insetAtRest(*owner.collision, surface, normals);
    Vec3 between;
    for (std::size_t side = 0; side < 2; ++side)
        for (std::size_t k = 0; k < 3; ++k)
            if (const int vertex = found.vertices[side][k]; vertex >= 0)
                between += (side == 0 ? 1.0 : -1.0) * found.weights[side][k] * rest[static_cast<std::size_t>(vertex)];
    const double gap = length(between) - insetAt(*owner.collision, found, 0) - insetAt(*owner.collision, found, 1);
    return std::max(0.0, skin - gap);
}

} // namespace filasofia::engine
