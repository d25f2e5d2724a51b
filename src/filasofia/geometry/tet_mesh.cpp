#include "filasofia/geometry/tet_mesh.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/check_points.h"
#include "filasofia/geometry/element_fault.h"
#include "filasofia/geometry/face_list.h"

#include <algorithm>
#include <numbers>

namespace filasofia::geometry {
namespace {

constexpr double kMinRelativeVolume = 1e-12; // volume over the cube of the longest edge

void checkEveryNodeIsUsed(const TetMesh& mesh, std::string_view name)
{
    std::vector<bool> used(mesh.nodes.size());
    for (const Tetrahedron& t : mesh.tetrahedra)
        for (int node : t) used[static_cast<std::size_t>(node)] = true;
    const auto unused = std::ranges::find(used, false);
    if (unused != used.end())
        fail(name, ": node ", unused - used.begin(), " must be in at least one tetrahedron, got none");
}

void checkLabels(const TetMesh& mesh, std::string_view name)
{
    if (!mesh.labels.empty() && mesh.labels.size() != mesh.tetrahedra.size())
        fail(name, ": labels must be one per tetrahedron (", mesh.tetrahedra.size(), "), got ", mesh.labels.size());
}

} // namespace

double signedVolume(const TetMesh& mesh, int tetrahedron)
{
    const auto [a, b, c, d] = mesh.tetrahedra[tetrahedron];
    return signedVolume(mesh.nodes[a], mesh.nodes[b], mesh.nodes[c], mesh.nodes[d]);
}

double quality(const TetMesh& mesh, int tetrahedron)
{
    const Tetrahedron& t = mesh.tetrahedra[tetrahedron];
    double sum = 0.0;
    for (auto [i, j] : kTetrahedronEdges) sum += lengthSquared(mesh.nodes[t[i]] - mesh.nodes[t[j]]);
    const double rms = std::sqrt(sum / 6.0);
    if (!(rms > 0.0)) return 0.0;
    return std::numbers::sqrt2 * 6.0 * signedVolume(mesh, tetrahedron) / (rms * rms * rms);
}

std::string elementFault(const TetMesh& mesh, const Tetrahedron& t)
{
    const int count = static_cast<int>(mesh.nodes.size());
    for (int node : t)
        if (node < 0 || node >= count) return text(" names node ", node, "; it must be in [0, ", count, ")");
    for (auto [i, j] : kTetrahedronEdges)
        if (t[i] == t[j]) return text(" names node ", t[i], " twice; its four nodes must differ");
    double longest = 0.0;
    for (auto [i, j] : kTetrahedronEdges) longest = std::max(longest, distance(mesh.nodes[t[i]], mesh.nodes[t[j]]));
    const double volume = signedVolume(mesh.nodes[t[0]], mesh.nodes[t[1]], mesh.nodes[t[2]], mesh.nodes[t[3]]);
    const double bound = kMinRelativeVolume * longest * longest * longest;
    if (volume > bound && std::isfinite(volume)) return {};
    return text(volume < 0.0 ? " is inverted" : " is flat", ": its volume must be > ", bound,
                " (1e-12 times its longest edge cubed), got ", volume);
}

std::string furtherFaults(const TetMesh& mesh, std::size_t first)
{
    std::size_t count = 0;
    for (std::size_t i = first; i < mesh.tetrahedra.size(); ++i)
        if (!elementFault(mesh, mesh.tetrahedra[i]).empty()) ++count;
    return count == 0 ? "" : text("; ", count, count == 1 ? " other is" : " others are", " faulty, too");
}

// Two neighbours orient their common face in opposite directions; the same direction means that both lie on one side.
// Of three at a face two do, whatever stands between them.
std::optional<std::array<int, 2>> sameSidePair(const TetMesh& mesh)
{
    const std::vector<Face> faces = sortedFaces(mesh);
    for (std::size_t i = 1; i < faces.size(); ++i)
        for (std::size_t k = i; k > 0 && i - k < 2 && faces[k - 1].nodes == faces[i].nodes; --k)
            if (faces[k - 1].even == faces[i].even) return std::array{faces[k - 1].tetrahedron, faces[i].tetrahedron};
    return {};
}

void check(const TetMesh& mesh, std::string_view name)
{
    if (mesh.tetrahedra.empty()) fail(name, ": must have at least 1 tetrahedron, got 0");
    checkPoints(mesh.nodes, name, "node");
    for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i)
        if (const std::string fault = elementFault(mesh, mesh.tetrahedra[i]); !fault.empty())
            fail(name, ": tetrahedron ", i, fault, furtherFaults(mesh, i + 1));
    checkEveryNodeIsUsed(mesh, name);
    checkLabels(mesh, name);
    if (const auto pair = sameSidePair(mesh))
        fail(name, ": tetrahedra ", (*pair)[0], " and ", (*pair)[1],
             " lie on the same side of their common face; they must lie on opposite sides");
}

std::size_t dropUnusedNodes(TetMesh& mesh)
{
    const std::size_t count = mesh.nodes.size();
    std::vector<int> renumbered(count, -1);
    for (const Tetrahedron& t : mesh.tetrahedra)
        for (const int node : t) {
            if (node < 0 || static_cast<std::size_t>(node) >= count) return 0;
            renumbered[static_cast<std::size_t>(node)] = 0;
        }
    int kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
        if (renumbered[i] < 0) continue;
        mesh.nodes[static_cast<std::size_t>(kept)] = mesh.nodes[i];
        renumbered[i] = kept++;
    }
    mesh.nodes.resize(static_cast<std::size_t>(kept));
    for (Tetrahedron& t : mesh.tetrahedra)
        for (int& node : t) node = renumbered[static_cast<std::size_t>(node)];
    return count - mesh.nodes.size();
}

} // namespace filasofia::geometry
