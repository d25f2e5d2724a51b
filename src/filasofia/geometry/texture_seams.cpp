#include "filasofia/geometry/texture_seams.h"

namespace filasofia::geometry {
namespace {

std::vector<std::array<double, 2>> ofFirstCorners(const TriangleMesh& mesh,
                                                  const std::vector<std::array<double, 2>>& ofCorners)
{
    std::vector<std::array<double, 2>> out(mesh.vertices.size());
    for (std::size_t corner = ofCorners.size(); corner-- > 0;) // the first one is written last
        out[static_cast<std::size_t>(mesh.triangles[corner / 3][corner % 3])] = ofCorners[corner];
    return out;
}

} // namespace

bool perCorner(const TriangleMesh& mesh)
{
    return mesh.uv.size() == 3 * mesh.triangles.size() && mesh.uv.size() != mesh.vertices.size();
}

void setUvOfCorners(TriangleMesh& mesh, std::vector<std::array<double, 2>> uv)
{
    mesh.uv = mesh.vertices.size() == uv.size() ? ofFirstCorners(mesh, uv) : std::move(uv);
}

std::vector<std::array<double, 2>> uvOfVertices(const TriangleMesh& mesh)
{
    return perCorner(mesh) ? ofFirstCorners(mesh, mesh.uv) : mesh.uv;
}

} // namespace filasofia::geometry
