#include "filasofia/engine/collision/normal_bounds.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

constexpr Bounds kAnyNormal{{-1.0f, -1.0f, -1.0f, 0.0f}, {-1.0f, -1.0f, -1.0f, 0.0f}};

Bounds normalOf(const CollisionSurface& surface, int triangle)
{
    const auto [a, b, c] = surface.shape->triangles[triangle];
    const Vec3 ab = surface.x[b] - surface.x[a], ac = surface.x[c] - surface.x[a], normal = cross(ab, ac);
    const double longest = std::max(lengthSquared(ab), lengthSquared(ac)), size = length(normal);
    if (!(size * size > kSliver * longest * longest)) return kAnyNormal; // also if a vertex is not finite
    const Vec3 n = 1.0 / size * normal;
    const FourFloats at{static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z), 0.0f};
    return {at, -at};
}

} // namespace

void boundNormals(const CollisionSurface& surface, NormalBounds& out)
{
    const CollisionShape& shape = *surface.shape;
    out.vertices.assign(shape.rest.size(), emptyBounds());
    out.own.assign(shape.elements.size(), kAnyNormal);
    for (std::size_t i = 0; i < shape.elements.size(); ++i) {
        const int t = shape.elements[i].triangle;
        if (t < 0) continue;
        const Bounds normal = out.own[i] = normalOf(surface, t);
        for (const int v : shape.triangles[t]) out.vertices[v] = merged(out.vertices[v], normal);
    }
    out.elements.resize(shape.elements.size());
    out.nodes.resize(shape.nodes.size());
    for (std::size_t n = shape.nodes.size(); n-- > 0;) { // every child before its parent
        const CollisionShape::Node& node = shape.nodes[n];
        if (node.count == 0) {
            out.nodes[n] = merged(out.nodes[n + 1], out.nodes[node.first]);
            continue;
        }
        out.nodes[n] = emptyBounds();
        for (int i = node.first; i < node.first + node.count; ++i) {
            out.elements[i] = shape.elements[i].triangle >= 0 ? emptyBounds() : kAnyNormal;
            for (const int v : shape.elements[i].vertices)
                if (v >= 0) out.elements[i] = merged(out.elements[i], out.vertices[v]);
            out.nodes[n] = merged(out.nodes[n], out.elements[i]);
        }
    }
}

} // namespace filasofia::engine
