#include "filasofia/core/error.h"
#include "filasofia/geometry/kuhn.h"
#include "filasofia/geometry/shape_checks.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/geometry/split_solid.h"

#include <cmath>
#include <numbers>
#include <string_view>

namespace filasofia::geometry::shapes {
namespace {

void checkLine(std::string_view shape, const std::vector<Vec3>& points)
{
    if (points.size() < 2) fail(shape, ": points must have at least 2 entries, got ", points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!isFinite(points[i])) fail(shape, ": points[", i, "] must be finite");
        if (i > 0 && !(length(points[i] - points[i - 1]) > 0.0))
            fail(shape, ": points[", i - 1, "] and points[", i, "] must be apart, their distance is 0 m");
    }
}

Vec3 anyAcross(Vec3 direction)
{
    return normalized(cross(direction, std::abs(direction.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
}

/// Two directions across a line at one of its points; with the line's own they are right-handed.
struct Section {
    Vec3 centre, across, up;

    [[nodiscard]] Vec3 at(double angle, double radius) const
    {
        return centre + radius * (std::cos(angle) * across + std::sin(angle) * up);
    }
};

/// The sections of a line at its points from `first` on, each turned as little as possible against the one before.
std::vector<Section> sectionsOf(std::string_view shape, const std::vector<Vec3>& points, std::size_t first = 0)
{
    std::vector<Section> sections;
    const auto edge = [&](std::size_t i) { return normalized(points[i + 1] - points[i]); };
    const std::size_t count = points.size();
    Vec3 across = anyAcross(edge(0));
    for (std::size_t i = first; i < count; ++i) {
        const Vec3 before = edge(i > 0 ? i - 1 : 0), after = edge(i + 1 < count ? i : count - 2);
        const Vec3 sum = before + after;
        if (!(length(sum) > 0.1)) fail(shape, ": the line must turn by less than 174 degrees at points[", i, "]");
        const Vec3 along = normalized(sum);
        across = normalized(across - dot(across, along) * along);
        sections.push_back({points[i], across, cross(along, across)});
    }
    return sections;
}

double angleOf(int side, int sides) { return 2.0 * std::numbers::pi * side / sides; }

} // namespace

std::shared_ptr<const TriangleMesh> tube(const std::vector<Vec3>& points, double radius, int sides, bool sharp)
{
    checkLine("tube", points);
    checkLength("tube", "radius", radius);
    checkCount("tube", "sides", sides, 3, 500);
    TriangleMesh mesh;
    for (const Section& section : sectionsOf("tube", points, sharp ? 1 : 0))
        for (int s = 0; s < sides; ++s) mesh.vertices.push_back(section.at(angleOf(s, sides), radius));
    const int rings = static_cast<int>(mesh.vertices.size()) / sides;
    const int front = static_cast<int>(mesh.vertices.size()), back = front + 1;
    mesh.vertices.push_back(points.front());
    mesh.vertices.push_back(points.back());
    for (int s = 0; s < sides; ++s) {
        const int t = (s + 1) % sides, last = (rings - 1) * sides;
        mesh.triangles.push_back({front, t, s});
        for (int r = 0; r + 1 < rings; ++r) {
            const int a = r * sides + s, b = r * sides + t;
            mesh.triangles.push_back({a, b, a + sides});
            mesh.triangles.push_back({b, b + sides, a + sides});
        }
        mesh.triangles.push_back({back, last + s, last + t});
    }
    return std::make_shared<const TriangleMesh>(std::move(mesh));
}

std::shared_ptr<const TetMesh> vessel(const std::vector<Vec3>& points, double radius, double wall,
                                      std::array<int, 2> cells)
{
    checkLine("vessel", points);
    checkLength("vessel", "radius", radius);
    checkLength("vessel", "wall", wall);
    checkCount("vessel", "cells[0]", cells[0], 4, 500);
    checkCount("vessel", "cells[1]", cells[1], 1, 100);
    if (cells[0] % 2 != 0) fail("vessel: cells[0] must be even, got ", cells[0]);
    const auto [sides, layers] = cells;
    checkTetrahedra("vessel", 6LL * sides * layers * (static_cast<std::int64_t>(points.size()) - 1));
    TetMesh mesh;
    const auto sections = sectionsOf("vessel", points);
    for (const Section& section : sections)
        for (int s = 0; s < sides; ++s)
            for (int k = 0; k <= layers; ++k)
                mesh.nodes.push_back(section.at(angleOf(s, sides), radius + wall * k / layers));
    // The axes of the grid: along the line, outwards, around. Around, the last cell ends where the first one begins.
    const auto node = [&, sides = sides, layers = layers](const std::array<int, 3>& p) {
        return (p[0] * sides + p[2] % sides) * (layers + 1) + p[1];
    };
    for (int i = 0; i + 1 < static_cast<int>(sections.size()); ++i)
        for (int k = 0; k < layers; ++k)
            for (int s = 0; s < sides; ++s) {
                addKuhnCell(mesh, {i, k, s}, node);
                for (std::size_t t = mesh.tetrahedra.size() - 6; t < mesh.tetrahedra.size(); ++t)
                    if (!(signedVolume(mesh, static_cast<int>(t)) > 0.0))
                        fail("vessel: the line turns too sharply at points[", i, "] or points[", i + 1,
                             "] for a vessel that is ", radius + wall, " m in radius");
            }
    return std::make_shared<const TetMesh>(std::move(mesh));
}

std::shared_ptr<const TetMesh> bladder(Vec3 halfAxes, double wall, std::array<int, 2> cells)
{
    for (const auto& [name, value] :
         {std::pair("halfAxes.x", halfAxes.x), {"halfAxes.y", halfAxes.y}, {"halfAxes.z", halfAxes.z}})
        checkLength("bladder", name, value);
    checkLength("bladder", "wall", wall);
    checkCount("bladder", "cells[0]", cells[0], 1, 100);
    checkCount("bladder", "cells[1]", cells[1], 1, 100);
    const auto [quarter, layers] = cells;
    const std::shared_ptr<const TriangleMesh> ball = sphere(1.0, quarter);
    const auto count = static_cast<std::int64_t>(ball->vertices.size());
    checkTetrahedra("bladder", 3LL * layers * static_cast<std::int64_t>(ball->triangles.size()));
    TetMesh mesh;
    for (int layer = 0; layer <= layers; ++layer) {
        const double out = wall * layer / layers;
        for (const Vec3& p : ball->vertices)
            mesh.nodes.push_back({(halfAxes.x + out) * p.x, (halfAxes.y + out) * p.y, (halfAxes.z + out) * p.z});
    }
    for (int layer = 0; layer < layers; ++layer)
        for (const Triangle& t : ball->triangles) {
            std::vector<std::int64_t> prism;
            for (const std::int64_t base : {layer * count, (layer + 1) * count})
                for (int node : t) prism.push_back(base + node);
            splitSolid(Solid::Prism, prism, [&](const std::array<std::int64_t, 4>& part) {
                Tetrahedron& each = mesh.tetrahedra.emplace_back();
                for (std::size_t k = 0; k < 4; ++k) each[k] = static_cast<int>(part[k]);
            });
        }
    return std::make_shared<const TetMesh>(std::move(mesh));
}

std::vector<Vec3> arc(double radius, double from, double to, int edges)
{
    checkLength("arc", "radius", radius);
    checkCount("arc", "edges", edges, 1, 100000);
    if (!(std::isfinite(from) && std::isfinite(to))) fail("arc: from and to must be finite, got ", from, " and ", to);
    std::vector<Vec3> points;
    for (int i = 0; i <= edges; ++i) {
        const double angle = from + (to - from) * i / edges;
        points.push_back({radius * std::cos(angle), radius * std::sin(angle), 0.0});
    }
    return points;
}

} // namespace filasofia::geometry::shapes
