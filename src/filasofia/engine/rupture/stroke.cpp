#include "filasofia/engine/rupture/stroke.h"

#include "filasofia/core/hash.h"
#include "filasofia/geometry/distance.h"

#include <algorithm>
#include <limits>
#include <map>

namespace filasofia::engine {
namespace {

/// Performs one step of a stroke. `tool` is null if the tool is no longer near the body.
RuptureReport continueStroke(EditableMesh& mesh, const Tool* tool, Stroke& stroke)
{
    RuptureReport done;
    const CutParameters parameters = parametersFor(mesh);
    if (!stroke.leaving && tool) {
        done = stroke.stroke.step(mesh, tool->segments, parameters);
        stroke.sinceCrossing = done.crossings > 0 ? 0.0 : stroke.sinceCrossing + tool->way;
        stroke.hasCut = stroke.hasCut || done.crossings > 0;
        if (!stroke.arrived && !stroke.stroke.away()) { // a returning blade continues the surface that it finds
            stroke.arrived = true;
            const int sheet = stroke.hasCut ? 0 : sheetAt(mesh, tool->segments);
            if (sheet > 0) stroke.stroke = BladeStroke(sheet);
        }
    }
    const bool through = stroke.hasCut && (stroke.stroke.away() || stroke.sinceCrossing > 2.0 * mesh.meanEdge());
    stroke.leaving = stroke.leaving || !tool || through;
    if (stroke.leaving) stroke.over = stroke.stroke.finish(mesh, parameters, done);
    stroke.hasOpened = stroke.hasOpened || done.openedFaces > 0;
    done.inVain = stroke.over && stroke.hasCut && !stroke.hasOpened ? 1 : 0;
    return done;
}

} // namespace

std::vector<std::array<int, 2>> cuttingEdges(const geometry::TriangleMesh& mesh,
                                             const std::vector<std::array<int, 2>>& edges,
                                             const geometry::CompressedRows& edgeTriangles)
{
    const auto normalOf = [&](int triangle) {
        const auto [a, b, c] = mesh.triangles[static_cast<std::size_t>(triangle)];
        const auto at = [&](int vertex) { return mesh.vertices[static_cast<std::size_t>(vertex)]; };
        return normalized(cross(at(b) - at(a), at(c) - at(a)));
    };
    std::vector<std::array<int, 2>> open, sharp;
    for (int e = 0; e < static_cast<int>(edges.size()); ++e) {
        const auto beside = edgeTriangles[e];
        if (beside.size() < 2)
            open.push_back(edges[static_cast<std::size_t>(e)]);
        else if (dot(normalOf(beside[0]), normalOf(beside[1])) < 1e-9)
            sharp.push_back(edges[static_cast<std::size_t>(e)]);
    }
    return !open.empty() ? open : !sharp.empty() ? sharp : edges;
}

std::vector<std::array<int, 2>> cuttingEdges(const geometry::TriangleMesh& mesh)
{
    std::map<std::array<int, 2>, std::vector<int>> uses;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const int a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
            uses[{std::min(a, b), std::max(a, b)}].push_back(static_cast<int>(t));
        }
    std::vector<std::array<int, 2>> edges;
    geometry::CompressedRows triangles{.start = {0}, .items = {}};
    for (const auto& [edge, of] : uses) {
        edges.push_back(edge);
        triangles.items.insert(triangles.items.end(), of.begin(), of.end());
        triangles.start.push_back(static_cast<int>(triangles.items.size()));
    }
    return cuttingEdges(mesh, edges, triangles);
}

void addBlade(const BladePath& blade, Tool& tool)
{
    for (const auto& [a, b] : blade.lines) {
        const auto from = static_cast<std::size_t>(a), to = static_cast<std::size_t>(b);
        tool.segments.push_back({blade.now[from], blade.now[to], blade.before[from], blade.before[to]});
    }
    for (std::size_t i = 0; i < blade.now.size(); ++i)
        tool.way = std::max(tool.way, distance(blade.now[i], blade.before[i]));
}

double distanceTo(const BladePath& blade, Vec3 point)
{
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& [from, to] : blade.lines) {
        const auto a = static_cast<std::size_t>(from), b = static_cast<std::size_t>(to);
        const Vec3 corners[] = {blade.before[a], blade.before[b], blade.now[b], blade.now[a]};
        for (int half : {1, 2}) {
            const Vec3 found = geometry::nearestOnTriangle(point, corners[0], corners[half], corners[half + 1]).point;
            nearest = std::min(nearest, distance(point, found));
        }
    }
    return nearest;
}

void beginStrokes(std::span<const Tool> tools, EditableMesh& mesh, std::vector<Stroke>& strokes)
{
    for (const Tool& tool : tools) {
        const auto isItsOwn = [&](const Stroke& stroke) { return stroke.tool == tool.body && !stroke.leaving; };
        if (std::ranges::none_of(strokes, isItsOwn)) strokes.push_back({tool.body, BladeStroke(mesh.newSheet())});
    }
}

std::vector<RuptureReport> cutWith(std::span<const Tool> tools, EditableMesh& mesh, std::vector<Stroke>& strokes)
{
    std::vector<RuptureReport> reports;
    for (Stroke& stroke : strokes) {
        const auto tool = std::ranges::find(tools, stroke.tool, &Tool::body);
        reports.push_back(continueStroke(mesh, tool == tools.end() ? nullptr : &*tool, stroke));
    }
    std::erase_if(strokes, [](const Stroke& stroke) { return stroke.over; });
    return reports;
}

std::uint64_t historyWith(const frame::TopologyEdit& edit, std::uint64_t before)
{
    Hasher hash;
    hash.add(before);
    static_assert(sizeof(frame::TetNodes) == 5 * sizeof(int)); // no padding: all bytes are numbers
    hash.addAll(std::span<const frame::TetNodes>(edit.changed));
    for (const frame::TopologyOp& op : edit.ops)
        if (const auto* made = std::get_if<frame::NewNode>(&op))
            hash.add(made->s);
        else if (const auto* moved = std::get_if<frame::NodeMove>(&op))
            for (double each : {moved->newRest.x, moved->newRest.y, moved->newRest.z}) hash.add(each);
    return hash.value();
}

} // namespace filasofia::engine
