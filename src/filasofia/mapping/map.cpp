#include "filasofia/mapping/map.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/error.h"
#include "filasofia/geometry/surface.h"
#include "filasofia/geometry/texture_seams.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>

namespace filasofia::mapping {
namespace {

bool before(Vec3 a, Vec3 b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

/// The node at exactly the position of each vertex; nullopt if some vertex has none.
std::optional<IdentityMap> matchNodes(const std::vector<Vec3>& nodes, const geometry::TriangleMesh& surface)
{
    std::vector<int> order(nodes.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](int a, int b) { return before(nodes[a], nodes[b]) || (nodes[a] == nodes[b] && a < b); });
    IdentityMap map;
    for (const Vec3& vertex : surface.vertices) {
        const auto found = std::lower_bound(order.begin(), order.end(), vertex,
                                            [&](int node, Vec3 place) { return before(nodes[node], place); });
        if (found == order.end() || nodes[*found] != vertex) return std::nullopt;
        map.nodes.push_back(*found);
    }
    return map;
}

void applyTo(const IdentityMap& map, const frame::SoftBodyFrame& body, std::span<Vec3> vertices)
{
    FILASOFIA_ASSERT(vertices.size() == map.nodes.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i] = body.positions[map.nodes[i]];
}

void applyTo(const BarycentricMap& map, const frame::SoftBodyFrame& body, std::span<Vec3> vertices)
{
    const auto& [nodes, weights] = map.embedding;
    FILASOFIA_ASSERT(vertices.size() == nodes.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        Vec3 sum;
        for (int k = 0; k < 4; ++k) sum += weights[i][k] * body.positions[nodes[i][k]];
        vertices[i] = sum;
    }
}

void applyTo(const TubeMap& map, const frame::SoftBodyFrame& body, std::span<Vec3> vertices)
{
    apply(map, body, vertices);
}

/// The triangles around each vertex, in their order.
std::vector<std::vector<int>> trianglesAround(const geometry::TriangleMesh& surface)
{
    std::vector<std::vector<int>> around(surface.vertices.size());
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
        for (int vertex : surface.triangles[t]) around[vertex].push_back(static_cast<int>(t));
    return around;
}

/// Whether two triangles that share `vertex` also share an edge there.
bool neighbours(const geometry::Triangle& a, const geometry::Triangle& b, int vertex)
{
    for (int i : a)
        if (i != vertex && std::find(b.begin(), b.end(), i) != b.end()) return true;
    return false;
}

/// Which of the nodes lie on what cuts have opened; empty if that is nothing.
std::vector<std::uint8_t> rimOf(const frame::Boundary& boundary, const std::vector<int>& nodes)
{
    std::vector<std::uint8_t> inside(boundary.rest.size(), 0);
    bool any = false;
    for (std::size_t t = 0; t < boundary.triangles.size(); ++t) {
        if (boundary.opened[t] == 0) continue;
        any = true;
        for (const int node : boundary.triangles[t]) inside[static_cast<std::size_t>(node)] = 1;
    }
    std::vector<std::uint8_t> rim(any ? nodes.size() : 0);
    for (std::size_t v = 0; v < rim.size(); ++v) rim[v] = inside[static_cast<std::size_t>(nodes[v])];
    return rim;
}

} // namespace

geometry::TriangleMesh withCreases(const geometry::TriangleMesh& surface, double angle)
{
    std::vector<Vec3> normals;
    for (const auto& [a, b, c] : surface.triangles) {
        const Vec3 n = cross(surface.vertices[b] - surface.vertices[a], surface.vertices[c] - surface.vertices[a]);
        normals.push_back(length(n) > 0.0 ? normalized(n) : Vec3{});
    }
    const double smooth = std::cos(angle);
    geometry::TriangleMesh out = surface;
    const bool ofVertices = !surface.uv.empty() && !geometry::perCorner(surface);
    const auto around = trianglesAround(surface);
    for (int v = 0; v < static_cast<int>(around.size()); ++v) {
        std::vector<int> left = around[v];
        for (bool first = true; !left.empty(); first = false) {
            std::vector<int> side{left.front()}; // grows by the triangles that continue it smoothly
            left.erase(left.begin());
            for (std::size_t i = 0; i < side.size(); ++i)
                std::erase_if(left, [&](int t) {
                    const bool goesOn = neighbours(surface.triangles[side[i]], surface.triangles[t], v) &&
                                        dot(normals[side[i]], normals[t]) >= smooth;
                    if (goesOn) side.push_back(t);
                    return goesOn;
                });
            if (first) continue; // this side keeps the vertex
            const int fresh = static_cast<int>(out.vertices.size());
            out.vertices.push_back(surface.vertices[v]);
            if (ofVertices) out.uv.push_back(surface.uv[v]);
            for (int t : side) std::replace(out.triangles[t].begin(), out.triangles[t].end(), v, fresh);
        }
    }
    if (geometry::perCorner(surface)) geometry::setUvOfCorners(out, surface.uv);
    return out;
}

MappedSurface mapBoundary(const geometry::TetMesh& rest)
{
    geometry::Surface surface = geometry::extractSurface(rest);
    return {std::move(surface.mesh), IdentityMap{std::move(surface.nodes)}};
}

MappedSurface mapBoundary(const frame::Boundary& boundary, bool opened)
{
    MappedSurface mapped;
    std::vector<int> nodes, vertexOf(boundary.rest.size(), -1);
    for (std::size_t t = 0; t < boundary.triangles.size(); ++t) {
        if ((boundary.opened[t] != 0) != opened) continue;
        geometry::Triangle triangle = boundary.triangles[t];
        for (int& corner : triangle) {
            int& vertex = vertexOf[static_cast<std::size_t>(corner)];
            if (vertex < 0) {
                vertex = static_cast<int>(nodes.size());
                nodes.push_back(corner);
                mapped.surface.vertices.push_back(boundary.rest[static_cast<std::size_t>(corner)]);
            }
            corner = vertex;
        }
        mapped.surface.triangles.push_back(triangle);
    }
    if (!opened) mapped.rim = rimOf(boundary, nodes);
    mapped.map = IdentityMap{std::move(nodes)};
    return mapped;
}

MappedSurface mapSurface(const geometry::TetMesh& rest, geometry::TriangleMesh surface)
{
    if (auto identity = matchNodes(rest.nodes, surface)) return {std::move(surface), std::move(*identity)};
    BarycentricMap map{geometry::embed(rest, surface.vertices)};
    return {std::move(surface), std::move(map)};
}

MappedSurface mapSheet(geometry::TriangleMesh rest)
{
    IdentityMap map;
    map.nodes.resize(rest.vertices.size());
    std::iota(map.nodes.begin(), map.nodes.end(), 0);
    return {std::move(rest), std::move(map)};
}

MappedSurface mapSheet(const geometry::TriangleMesh& rest, geometry::TriangleMesh surface, const std::string& object)
{
    auto identity = matchNodes(rest.vertices, surface);
    if (!identity)
        fail(object, ": surface must have its vertices at nodes of the shell: a finer surface cannot follow it yet");
    return {std::move(surface), std::move(*identity)};
}

int nodesNeeded(const SoftMap& map)
{
    int highest = -1;
    if (const auto* identity = std::get_if<IdentityMap>(&map))
        for (const int node : identity->nodes) highest = std::max(highest, node);
    else if (const auto* tube = std::get_if<TubeMap>(&map))
        return tube->nodes;
    else
        for (const geometry::Tetrahedron& nodes : std::get<BarycentricMap>(map).embedding.nodes)
            for (const int node : nodes) highest = std::max(highest, node);
    return highest + 1;
}

Pose apply(const RigidMap& map, const frame::RigidBodyFrame& body)
{
    FILASOFIA_ASSERT(map.element >= 0 && map.element < static_cast<int>(body.poses.size()));
    return body.poses[map.element];
}

void apply(const SoftMap& map, const frame::SoftBodyFrame& body, std::span<Vec3> vertices)
{
    std::visit([&](const auto& each) { applyTo(each, body, vertices); }, map);
}

} // namespace filasofia::mapping
