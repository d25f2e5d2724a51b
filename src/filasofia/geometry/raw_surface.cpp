#include "filasofia/geometry/raw_surface.h"

#include "filasofia/core/log.h"
#include "filasofia/geometry/texture_seams.h"

namespace filasofia::geometry {
namespace {

int pointOf(const RawSurface& raw, const RawSurface::Polygon& polygon, std::size_t corner, const NumberSource& file)
{
    const std::int64_t number = raw.corners[polygon.begin + corner];
    const auto end = raw.first + static_cast<std::int64_t>(raw.points.size());
    if (number < raw.first || number >= end)
        file.failAt(polygon.place, "polygon ", polygon.number, " must name points in [", raw.first, ", ", end,
                    "), got ", number);
    return static_cast<int>(number - raw.first);
}

TriangleMesh dropUnusedPoints(TriangleMesh mesh, std::string_view name)
{
    std::vector<int> renumbered(mesh.vertices.size(), -1);
    for (const Triangle& each : mesh.triangles)
        for (const int vertex : each) renumbered[vertex] = 0;
    int kept = 0;
    for (std::size_t i = 0; i < renumbered.size(); ++i) {
        if (renumbered[i] < 0) continue;
        mesh.vertices[kept] = mesh.vertices[i];
        if (!mesh.uv.empty()) mesh.uv[kept] = mesh.uv[i];
        renumbered[i] = kept++;
    }
    const std::size_t dropped = mesh.vertices.size() - static_cast<std::size_t>(kept);
    if (dropped > 0) logInfo(name, ": ", dropped, " points that no triangle uses were dropped");
    mesh.vertices.resize(kept);
    if (!mesh.uv.empty()) mesh.uv.resize(kept);
    for (Triangle& each : mesh.triangles)
        for (int& vertex : each) vertex = renumbered[vertex];
    return mesh;
}

} // namespace

void RawSurface::add(std::span<const std::int64_t> polygon, std::int64_t number, std::size_t place)
{
    polygons.push_back({number, place, corners.size(), polygon.size()});
    corners.insert(corners.end(), polygon.begin(), polygon.end());
}

TriangleMesh resolve(const RawSurface& raw, const NumberSource& file, std::string_view name)
{
    TriangleMesh mesh{raw.points, {}, raw.uv};
    const bool seams = !raw.uvOfCorners.empty();
    if (seams && (raw.uvOfCorners.size() != raw.corners.size() || raw.corners.size() != 3 * raw.polygons.size()))
        fail(name, ": texture coordinates of corners must be one pair for each corner of triangles (",
             raw.corners.size(), "), got ", raw.uvOfCorners.size());
    std::vector<std::array<double, 2>> ofCorners;
    std::size_t dropped = 0;
    for (const RawSurface::Polygon& polygon : raw.polygons) {
        if (polygon.count < 3)
            file.failAt(polygon.place, "polygon ", polygon.number, " must have at least 3 corners, got ",
                        polygon.count);
        const int a = pointOf(raw, polygon, 0, file);
        for (std::size_t k = 1; k + 1 < polygon.count; ++k) {
            const int b = pointOf(raw, polygon, k, file), c = pointOf(raw, polygon, k + 1, file);
            if (a == b || b == c || c == a) {
                ++dropped;
                continue;
            }
            mesh.triangles.push_back({a, b, c});
            for (std::size_t i = 0; seams && i < 3; ++i) ofCorners.push_back(raw.uvOfCorners[polygon.begin + i]);
        }
    }
    if (mesh.triangles.empty())
        fail(name, ": must have at least 1 triangle, got 0",
             raw.solids > 0 ? text("; it has ", raw.solids, " solids, which make a tetrahedral mesh") : "");
    if (dropped > 0) logWarning(name, ": dropped ", dropped, " triangles that name a vertex twice");
    if (raw.solids > 0) logWarning(name, ": ", raw.solids, " solids were left out: only polygons make a surface");
    if (raw.secondOrder > 0)
        logWarning(name, ": ", raw.secondOrder, " polygons of second order were read with their corners only");
    if (!raw.keepsUnused) mesh = dropUnusedPoints(std::move(mesh), name);
    if (seams) setUvOfCorners(mesh, std::move(ofCorners));
    check(mesh, name);
    return mesh;
}

} // namespace filasofia::geometry
