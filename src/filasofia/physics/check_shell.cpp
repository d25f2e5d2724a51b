#include "filasofia/physics/check_shell.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/mass_properties.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
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

/// From the first corner of a triangle to the other two.
std::array<Vec3, 2> sidesOf(const TriangleMesh& mesh, std::size_t triangle)
{
    const auto [a, b, c] = mesh.triangles[triangle];
    const Vec3 from = mesh.vertices[static_cast<std::size_t>(a)];
    return {mesh.vertices[static_cast<std::size_t>(b)] - from, mesh.vertices[static_cast<std::size_t>(c)] - from};
}

Vec3 normalOf(const TriangleMesh& mesh, std::size_t triangle)
{
    const auto [ab, ac] = sidesOf(mesh, triangle);
    return cross(ab, ac);
}

/// A flat triangle has no normal and no metric.
void checkShapes(const TriangleMesh& mesh, const std::string& object)
{
    constexpr double kFlattest = 1e-4; // [-] height over the longest edge
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto [ab, ac] = sidesOf(mesh, i);
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

using ShellEdge = std::array<int, 2>; ///< the lower vertex first

struct EdgeUse {
    int triangles = 0, forwards = 0;
    std::array<std::size_t, 2> which{}; ///< the first two triangles
};

std::map<ShellEdge, EdgeUse> shellEdgesOf(const TriangleMesh& mesh)
{
    std::map<ShellEdge, EdgeUse> edges;
    for (std::size_t each = 0; each < mesh.triangles.size(); ++each)
        for (std::size_t i = 0; i < 3; ++i) {
            const Triangle& t = mesh.triangles[each];
            const auto [low, high] = std::minmax(t[i], t[(i + 1) % 3]);
            EdgeUse& edge = edges[{low, high}];
            if (edge.triangles < 2) edge.which[static_cast<std::size_t>(edge.triangles)] = each;
            ++edge.triangles;
            edge.forwards += t[i] == low ? 1 : 0;
        }
    return edges;
}

void checkEdges(const std::map<ShellEdge, EdgeUse>& edges, const std::string& object)
{
    for (const auto& [ends, edge] : edges) {
        if (edge.triangles > 2)
            fail(object, ": edge ", ends[0], " ", ends[1], " must belong to 1 or 2 triangles of the shell, got ",
                 edge.triangles);
        if (edge.triangles == 2 && edge.forwards != 1)
            fail(object, ": the two triangles at edge ", ends[0], " ", ends[1],
                 " must face the same way, but one is turned over");
    }
}

/// The angle between two triangles jumps from pi to -pi where they lie on each other, so a fold has no state of rest.
void checkFolds(const TriangleMesh& mesh, const std::map<ShellEdge, EdgeUse>& edges, const std::string& object)
{
    constexpr double kSharpest = std::numbers::pi - 1e-2; // [rad]
    for (const auto& [ends, edge] : edges) {
        if (edge.triangles != 2) continue;
        const Vec3 a = normalOf(mesh, edge.which[0]), b = normalOf(mesh, edge.which[1]);
        const double angle = std::atan2(length(cross(a, b)), dot(a, b));
        if (angle > kSharpest)
            fail(object, ": the two triangles at edge ", ends[0], " ", ends[1],
                 " must not lie on each other: the angle "
                 "between their normals must be <= ",
                 kSharpest, " rad unless bendingScale is 0, got ", angle);
    }
}

/// Pressure presses on the front of a closed shell.
void checkFacing(const TriangleMesh& mesh, const std::map<ShellEdge, EdgeUse>& edges, const std::string& object)
{
    const bool closed = std::ranges::all_of(edges, [](const auto& each) { return each.second.triangles == 2; });
    const double volume = closed ? geometry::enclosedVolume(mesh) : 0.0;
    if (volume < 0.0)
        fail(object, ": the triangles of a closed shell must face outwards, but it encloses ", volume, " m^3");
}

} // namespace

void checkShell(const TriangleMesh& mesh, bool bends, const std::string& object)
{
    checkVertices(mesh, object);
    checkShapes(mesh, object);
    checkTwice(mesh, object);
    const std::map<ShellEdge, EdgeUse> edges = shellEdgesOf(mesh);
    checkEdges(edges, object);
    if (bends) checkFolds(mesh, edges, object);
    checkFacing(mesh, edges, object);
}

} // namespace filasofia::physics
