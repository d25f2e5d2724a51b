#include "filasofia/geometry/embedding.h"

#include "filasofia/core/assert.h"
#include "filasofia/geometry/bvh.h"
#include "filasofia/geometry/distance.h"

#include <algorithm>

namespace filasofia::geometry {
namespace {

constexpr double kInside = -1e-12; // a weight this small is rounding: the point lies on the face

std::vector<Box> boxesOf(const TetMesh& mesh)
{
    std::vector<Box> boxes;
    boxes.reserve(mesh.tetrahedra.size());
    for (const Tetrahedron& t : mesh.tetrahedra) {
        Box box;
        for (int node : t) box = merged(box, mesh.nodes[node]);
        // A point that its weights put inside may lie outside the box by rounding; the margin is far above that.
        boxes.push_back(grown(box, 1e-9 * length(box.high - box.low)));
    }
    return boxes;
}

} // namespace

Embedding embed(const TetMesh& mesh, std::span<const Vec3> points)
{
    FILASOFIA_ASSERT(!mesh.tetrahedra.empty());
    const Bvh tree(boxesOf(mesh));
    const auto weightsIn = [&](int t, Vec3 p) {
        const auto [a, b, c, d] = mesh.tetrahedra[t];
        return barycentric(p, mesh.nodes[a], mesh.nodes[b], mesh.nodes[c], mesh.nodes[d]);
    };
    const auto squaredDistance = [&](int t, Vec3 p) {
        if (std::ranges::min(weightsIn(t, p)) >= kInside) return 0.0;
        const auto [a, b, c, d] = mesh.tetrahedra[t];
        return nearestInTetrahedron(p, mesh.nodes[a], mesh.nodes[b], mesh.nodes[c], mesh.nodes[d]).squaredDistance;
    };
    Embedding embedding;
    embedding.nodes.reserve(points.size());
    embedding.weights.reserve(points.size());
    for (Vec3 p : points) {
        FILASOFIA_ASSERT(isFinite(p));
        // Beyond 1e154 m a squared distance is infinite and the tree finds nothing: then the first tetrahedron is used.
        const int holder = std::max(0, tree.nearest(p, [&](int t) { return squaredDistance(t, p); }).primitive);
        embedding.nodes.push_back(mesh.tetrahedra[holder]);
        embedding.weights.push_back(weightsIn(holder, p));
    }
    return embedding;
}

} // namespace filasofia::geometry
