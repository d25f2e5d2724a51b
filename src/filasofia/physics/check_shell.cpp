#include "filasofia/physics/check_shell.h"

#include "filasofia/core/error.h"

#include <algorithm>
#include <map>
#include <vector>

namespace filasofia::physics {
namespace {

using geometry::Triangle;
using geometry::TriangleMesh;

std::string name(const Triangle& t) { return text(t[0], " ", t[1], " ", t[2]); }

void checkVertices(const TriangleMesh& mesh, const std::string& object)
{
    std::vector<bool> used(mesh.vertices.size());
    for (const Triangle& t : mesh.triangles)
        for (int vertex : t) used[static_cast<std::size_t>(vertex)] = true;
    const auto lone = std::ranges::find(used, false);
    if (lone != used.end())
        fail(object, ": vertex ", lone - used.begin(), " must belong to a triangle of the shell, but belongs to none");
}

/// A flat triangle has no normal and no metric.
void checkShapes(const TriangleMesh& mesh, const std::string& object)
{
    constexpr double kFlattest = 1e-4; // [-] height over the longest edge
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto [a, b, c] = mesh.triangles[i];
        const Vec3 ab = mesh.vertices[static_cast<std::size_t>(b)] - mesh.vertices[static_cast<std::size_t>(a)];
        const Vec3 ac = mesh.vertices[static_cast<std::size_t>(c)] - mesh.vertices[static_cast<std::size_t>(a)];
        const double longest = std::max({lengthSquared(ab), lengthSquared(ac), lengthSquared(ac - ab)});
        const double height = longest > 0.0 ? length(cross(ab, ac)) / longest : 0.0;
        if (!(height > kFlattest))
            fail(object, ": triangle ", i, " (", name(mesh.triangles[i]), ") must have a height > ", kFlattest,
                 " of its longest edge, got ", height);
    }
}

void checkTwice(const TriangleMesh& mesh, const std::string& object)
{
    std::map<Triangle, std::size_t> first;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        Triangle key = mesh.triangles[i];
        std::ranges::sort(key);
        const auto [known, fresh] = first.emplace(key, i);
        if (!fresh)
            fail(object, ": triangle ", i, " (", name(mesh.triangles[i]), ") must differ from triangle ", known->second,
                 ", which has the same vertices");
    }
}

void checkEdges(const TriangleMesh& mesh, const std::string& object)
{
    struct Around {
        int triangles = 0, forwards = 0;
    };
    std::map<std::array<int, 2>, Around> edges;
    for (const Triangle& t : mesh.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const auto [low, high] = std::minmax(t[i], t[(i + 1) % 3]);
            Around& edge = edges[{low, high}];
            ++edge.triangles;
            edge.forwards += t[i] == low ? 1 : 0;
        }
    for (const auto& [ends, edge] : edges) {
        if (edge.triangles > 2)
            fail(object, ": edge ", ends[0], " ", ends[1], " must belong to 1 or 2 triangles of the shell, got ",
                 edge.triangles);
        if (edge.triangles == 2 && edge.forwards != 1)
            fail(object, ": the two triangles at edge ", ends[0], " ", ends[1],
                 " must face the same way, but one is turned over");
    }
}

} // namespace

void checkShell(const TriangleMesh& mesh, const std::string& object)
{
    checkVertices(mesh, object);
    checkShapes(mesh, object);
    checkTwice(mesh, object);
    checkEdges(mesh, object);
}

} // namespace filasofia::physics
