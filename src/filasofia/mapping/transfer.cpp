#include "filasofia/mapping/transfer.h"

#include "filasofia/geometry/bvh.h"
#include "filasofia/geometry/distance.h"

namespace filasofia::mapping {

SurfaceTransfer transferBetween(const geometry::TriangleMesh& old, const geometry::TriangleMesh& fresh)
{
    const auto corner = [&](int triangle, int k) { return old.vertices[old.triangles[triangle][k]]; };
    std::vector<geometry::Box> boxes(old.triangles.size());
    geometry::Box all;
    for (int t = 0; t < static_cast<int>(boxes.size()); ++t) {
        for (int k = 0; k < 3; ++k) boxes[t] = merged(boxes[t], corner(t, k));
        all = merged(all, boxes[t]);
    }
    const double reach = geometry::isEmpty(all) ? 0.0 : 1e-6 * distance(all.low, all.high);
    const geometry::Bvh tree(boxes);

    SurfaceTransfer transfer;
    transfer.vertices.assign(fresh.vertices.size(),
                             {SurfaceTransfer::kNone, SurfaceTransfer::kNone, SurfaceTransfer::kNone});
    transfer.weights.resize(fresh.vertices.size());
    for (std::size_t i = 0; i < fresh.vertices.size(); ++i) {
        const Vec3 p = fresh.vertices[i];
        // Most vertices of a cut surface are old ones at their old positions.
        const auto nearest = [&](int t) {
            return geometry::nearestOnTriangle(p, corner(t, 0), corner(t, 1), corner(t, 2));
        };
        const auto found = tree.nearest(
            p, [&](int t) { return nearest(t).squaredDistance; }, reach * reach);
        if (found.primitive < 0) continue;
        transfer.vertices[i] = old.triangles[found.primitive];
        transfer.weights[i] = nearest(found.primitive).weights;
        for (std::size_t k = 0; k < 3; ++k) // an existing vertex keeps its value bit for bit
            if (p == corner(found.primitive, static_cast<int>(k)))
                transfer.weights[i] = {k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0};
    }
    return transfer;
}

} // namespace filasofia::mapping
