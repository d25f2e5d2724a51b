#include "filasofia/geometry/face_list.h"

#include <algorithm>

namespace filasofia::geometry {
namespace {

Face namedFace(const Tetrahedron& t, int tetrahedron, int side)
{
    const auto [i, j, k] = kTetrahedronFaces[side];
    Face face{{t[i], t[j], t[k]}, tetrahedron, side, true};
    auto& n = face.nodes;
    const auto order = [&](int a, int b) {
        if (n[a] > n[b]) std::swap(n[a], n[b]), face.even = !face.even;
    };
    order(0, 1), order(1, 2), order(0, 1);
    return face;
}

} // namespace

std::vector<Face> sortedFaces(const TetMesh& mesh)
{
    std::vector<Face> faces;
    faces.reserve(4 * mesh.tetrahedra.size());
    for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t)
        for (int side = 0; side < 4; ++side) faces.push_back(namedFace(mesh.tetrahedra[t], t, side));
    std::ranges::sort(faces, [](const Face& a, const Face& b) {
        if (a.nodes != b.nodes) return a.nodes < b.nodes;
        return a.tetrahedron != b.tetrahedron ? a.tetrahedron < b.tetrahedron : a.side < b.side;
    });
    return faces;
}

} // namespace filasofia::geometry
