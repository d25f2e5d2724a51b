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
    // Faces are first counted into rows by their lowest node: a row has some dozen faces, and one sort of all faces
    // took three times as long.
    int last = -1; // the mesh may list no nodes: topology alone is enough here
    for (const Tetrahedron& t : mesh.tetrahedra) last = std::max({last, t[0], t[1], t[2], t[3]});
    std::vector<std::size_t> rows(static_cast<std::size_t>(last) + 2, 0);
    for (const Tetrahedron& t : mesh.tetrahedra)
        for (const auto& [i, j, k] : kTetrahedronFaces) ++rows[std::min({t[i], t[j], t[k]}) + 1];
    for (std::size_t n = 1; n < rows.size(); ++n) rows[n] += rows[n - 1];
    std::vector<Face> faces(4 * mesh.tetrahedra.size());
    std::vector<std::size_t> next(rows.begin(), rows.end() - 1);
    for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t)
        for (int side = 0; side < 4; ++side) {
            const Face face = namedFace(mesh.tetrahedra[t], t, side);
            faces[next[face.nodes[0]]++] = face;
        }
    for (std::size_t n = 1; n < rows.size(); ++n)
        std::sort(faces.begin() + static_cast<std::ptrdiff_t>(rows[n - 1]),
                  faces.begin() + static_cast<std::ptrdiff_t>(rows[n]), [](const Face& a, const Face& b) {
                      if (a.nodes[1] != b.nodes[1]) return a.nodes[1] < b.nodes[1];
                      if (a.nodes[2] != b.nodes[2]) return a.nodes[2] < b.nodes[2];
                      return a.tetrahedron != b.tetrahedron ? a.tetrahedron < b.tetrahedron : a.side < b.side;
                  });
    return faces;
}

} // namespace filasofia::geometry
