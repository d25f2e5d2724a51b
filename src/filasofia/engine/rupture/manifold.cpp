#include "filasofia/engine/rupture/manifold.h"

#include "filasofia/engine/rupture/tet_shape.h"

#include <algorithm>

namespace filasofia::engine {

std::vector<FaceLoop> boundaryLoops(const MeshTopology& mesh, int node)
{
    struct Face {
        std::array<int, 2> side;
        std::array<int, 2> link; ///< its two other nodes
        int loop;
    };
    std::vector<Face> faces;
    for (int t : mesh.around[node])
        for (int f = 0; f < 4; ++f) {
            if (mesh.neighbours[t][f] >= 0 || mesh.tetrahedra[t][f] == node) continue;
            std::array<int, 2> link{};
            int count = 0;
            for (int n : faceNodes(mesh.tetrahedra[t], f))
                if (n != node) link[count++] = n;
            faces.push_back({{t, f}, link, -1});
        }
    std::vector<FaceLoop> loops;
    std::vector<int> stack;
    for (int first = 0; first < static_cast<int>(faces.size()); ++first) {
        if (faces[first].loop >= 0) continue;
        const int loop = static_cast<int>(loops.size());
        loops.emplace_back();
        faces[first].loop = loop;
        stack = {first};
        while (!stack.empty()) {
            const Face at = faces[stack.back()];
            stack.pop_back();
            loops[loop].push_back(at.side);
            for (int i = 0; i < static_cast<int>(faces.size()); ++i) {
                const std::array<int, 2>& l = faces[i].link;
                if (faces[i].loop >= 0 ||
                    (l[0] != at.link[0] && l[0] != at.link[1] && l[1] != at.link[0] && l[1] != at.link[1]))
                    continue;
                faces[i].loop = loop;
                stack.push_back(i);
            }
        }
    }
    return loops;
}

bool isOneFan(const MeshTopology& mesh, int a, int b)
{
    std::vector<int> star;
    edgeStar(mesh, a, b, star);
    if (star.size() <= 1) return true;
    std::vector<char> seen(star.size(), 0);
    std::vector<int> stack{0};
    seen[0] = 1;
    std::size_t count = 1;
    while (!stack.empty()) {
        const int t = star[stack.back()];
        stack.pop_back();
        for (int f = 0; f < 4; ++f) {
            const int corner = mesh.tetrahedra[t][f], other = mesh.neighbours[t][f];
            if (corner == a || corner == b || other < 0) continue;
            const auto at = std::ranges::find(star, other);
            if (at == star.end() || seen[at - star.begin()]) continue;
            seen[at - star.begin()] = 1;
            ++count;
            stack.push_back(static_cast<int>(at - star.begin()));
        }
    }
    return count == star.size();
}

} // namespace filasofia::engine
