#include "filasofia/geometry/triangle_mesh.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/check_points.h"
#include "filasofia/geometry/texture_seams.h"

namespace filasofia::geometry {

void check(const TriangleMesh& mesh, std::string_view name)
{
    const int count = static_cast<int>(mesh.vertices.size());
    if (mesh.triangles.empty()) fail(name, ": must have at least 1 triangle, got 0");
    checkPoints(mesh.vertices, name, "vertex");
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const Triangle& t = mesh.triangles[i];
        for (int vertex : t)
            if (vertex < 0 || vertex >= count)
                fail(name, ": triangle ", i, " names vertex ", vertex, "; it must be in [0, ", count, ")");
        if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
            fail(name, ": triangle ", i, " names a vertex twice: ", t[0], " ", t[1], " ", t[2],
                 "; its three vertices must differ");
    }
    if (!mesh.uv.empty() && mesh.uv.size() != mesh.vertices.size() && !perCorner(mesh))
        fail(name, ": uv must be empty or have one pair for each of ", count, " vertices or of ",
             3 * mesh.triangles.size(), " corners, got ", mesh.uv.size());
    for (std::size_t i = 0; i < mesh.uv.size(); ++i)
        if (const auto [u, v] = mesh.uv[i]; !std::isfinite(u) || !std::isfinite(v))
            fail(name, ": uv of ", perCorner(mesh) ? "corner " : "vertex ", i, " must be finite, got ", u, " ", v);
}

} // namespace filasofia::geometry
