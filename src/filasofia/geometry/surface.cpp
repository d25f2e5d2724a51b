#include "filasofia/geometry/surface.h"

#include "filasofia/geometry/face_list.h"

#include <algorithm>

namespace filasofia::geometry {
namespace {

// The faces that no other tetrahedron shares, in the order of the tetrahedra and their sides.
std::vector<Face> boundaryFaces(const TetMesh& mesh)
{
    const std::vector<Face> faces = sortedFaces(mesh);
    std::vector<Face> alone;
    for (std::size_t i = 0; i < faces.size(); ++i) {
        const bool likePrevious = i > 0 && faces[i - 1].nodes == faces[i].nodes;
        const bool likeNext = i + 1 < faces.size() && faces[i + 1].nodes == faces[i].nodes;
        if (!likePrevious && !likeNext) alone.push_back(faces[i]);
    }
    std::ranges::sort(alone, [](const Face& a, const Face& b) {
        return a.tetrahedron != b.tetrahedron ? a.tetrahedron < b.tetrahedron : a.side < b.side;
    });
    return alone;
}

} // namespace

Surface extractSurface(const TetMesh& mesh)
{
    const std::vector<Face> faces = boundaryFaces(mesh);
    constexpr int kInside = -1;
    std::vector<int> vertexOfNode(mesh.nodes.size(), kInside);
    for (const Face& face : faces)
        for (int node : face.nodes) vertexOfNode[node] = 0;

    Surface surface;
    for (int node = 0; node < static_cast<int>(mesh.nodes.size()); ++node) {
        if (vertexOfNode[node] == kInside) continue;
        vertexOfNode[node] = static_cast<int>(surface.nodes.size());
        surface.nodes.push_back(node);
        surface.mesh.vertices.push_back(mesh.nodes[node]);
    }
    surface.mesh.triangles.reserve(faces.size());
    for (const Face& face : faces) {
        const Tetrahedron& t = mesh.tetrahedra[face.tetrahedron];
        const auto [i, j, k] = kTetrahedronFaces[face.side];
        surface.mesh.triangles.push_back({vertexOfNode[t[i]], vertexOfNode[t[j]], vertexOfNode[t[k]]});
    }
    return surface;
}

} // namespace filasofia::geometry
