#include "filasofia/engine/collision/collision_surface.h"

#include "filasofia/core/assert.h"
#include "filasofia/engine/collision/vertex_bounds.h"

#include <cmath>

namespace filasofia::engine {
void boundVertices(CollisionSurface& surface, double reach, double margin, Vec3 drift)
{
    const std::size_t count = surface.shape->rest.size();
    FILASOFIA_ASSERT(surface.x.size() == count && surface.v.size() == count);
    surface.vertexBounds.resize(count);
    surface.whole = emptyBounds();
    const auto depth = static_cast<float>(margin), time = static_cast<float>(reach);
    for (std::size_t i = 0; i < count; ++i) {
        surface.vertexBounds[i] = boundsOf(surface.x[i], surface.v[i] - drift, depth, time);
        surface.whole = merged(surface.whole, surface.vertexBounds[i]);
    }
}

void boundMotion(CollisionSurface& surface, double dt, Vec3 drift, double margin)
{
    const std::size_t count = surface.shape->rest.size();
    surface.vertexBounds.resize(count);
    surface.whole = emptyBounds();
    const auto radius = static_cast<float>(margin);
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3 from = surface.x[i], to = from + dt * (surface.v[i] - drift);
        surface.vertexBounds[i] = merged(boxAround(from, radius), boxAround(to, radius));
        surface.whole = merged(surface.whole, surface.vertexBounds[i]);
    }
    boundTree(surface);
}

void boundTree(CollisionSurface& surface)
{
    const CollisionShape& shape = *surface.shape;
    surface.elementBounds.resize(shape.elements.size());
    surface.nodeBounds.resize(shape.nodes.size());
    // Children follow their parent, so backwards every child is ready before its parent.
    for (std::size_t n = shape.nodes.size(); n-- > 0;) {
        const CollisionShape::Node& node = shape.nodes[n];
        if (node.count == 0) {
            surface.nodeBounds[n] = merged(surface.nodeBounds[n + 1], surface.nodeBounds[node.first]);
            continue;
        }
        Bounds all = emptyBounds();
        for (int i = node.first; i < node.first + node.count; ++i) {
            const std::array<int, 3>& corners = shape.elements[i].vertices;
            Bounds box = surface.vertexBounds[corners[0]];
            if (corners[1] >= 0) box = merged(box, surface.vertexBounds[corners[1]]);
            if (corners[2] >= 0) box = merged(box, surface.vertexBounds[corners[2]]);
            surface.elementBounds[i] = damaged(box) ? damagedBounds() : box;
            all = merged(all, surface.elementBounds[i]);
        }
        surface.nodeBounds[n] = all;
    }
}

double sizeOf(const CollisionSurface& surface)
{
    double squared = 0.0;
    for (int k = 0; k < 3; ++k) {
        const double width =
            -static_cast<double>(surface.whole.negatedHigh[k]) - static_cast<double>(surface.whole.low[k]);
        squared += width * width;
    }
    return std::sqrt(squared);
}

} // namespace filasofia::engine
