#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/engine/rupture/cut.h"
#include "filasofia/engine/rupture/cut_surface.h"
#include "filasofia/geometry/adjacency.h"

/// From the blades of tools to cuts: which edges of a blade cut, when a stroke begins and ends, and how near a blade
/// came to a point.
namespace filasofia::engine {

/// All blades of one rigid body near a soft body: both jaws of scissors cut one surface.
struct Tool {
    BodyId body = {};
    std::vector<BladeSegment> segments = {};
    double way = 0.0; ///< [m] longest path of a vertex in the step
};

/// A blade's cutting edges, by its vertices, and where these are at the start and the end of a step [m].
struct BladePath {
    std::span<const std::array<int, 2>> lines;
    std::span<const Vec3> before, now;
};

/// The stroke of a rigid body's blades through a soft body.
struct Stroke {
    BodyId tool;
    BladeStroke stroke;
    bool arrived = false;       ///< part of the mesh has been near the blades
    bool hasCut = false;        ///< the stroke has crossed an edge of the mesh
    bool hasOpened = false;     ///< and opened a face
    double sinceCrossing = 0.0; ///< [m] way of the blades since they last crossed an edge
    bool leaving = false;       ///< the stroke finishes its pending work and is then over
    bool over = false;
};

/// The edges of a blade that cut: boundary edges, those with at most one triangle. If a mesh has none (it is closed),
/// the edges sharper than a right angle cut; if it has none of these either, all edges do. `edgeTriangles`: per edge.
std::vector<std::array<int, 2>> cuttingEdges(const geometry::TriangleMesh& mesh,
                                             const std::vector<std::array<int, 2>>& edges,
                                             const geometry::CompressedRows& edgeTriangles);
std::vector<std::array<int, 2>> cuttingEdges(const geometry::TriangleMesh& mesh);

/// Adds a blade to its tool.
void addBlade(const BladePath& blade, Tool& tool);

/// How near the path of a blade's edges came to a point [m].
double distanceTo(const BladePath& blade, Vec3 point);

/// Gives each tool near a mesh a stroke, if it has none that cuts.
void beginStrokes(std::span<const Tool> tools, EditableMesh& mesh, std::vector<Stroke>& strokes);
/// Performs one step of every stroke; `tools` are those near the mesh, which has followed the body. A stroke ends after
/// its blades have moved two mean edges without crossing anything, or are away from the body. What they cut later is a
/// new cut. Returns the reports of the strokes, in their order; those that are over are gone then.
std::vector<RuptureReport> cutWith(std::span<const Tool> tools, EditableMesh& mesh, std::vector<Stroke>& strokes);

/// Hash of all edits so far, of which `before` is that of the earlier ones: if two histories are equal, the meshes are
/// equal.
std::uint64_t historyWith(const frame::TopologyEdit& edit, std::uint64_t before);

} // namespace filasofia::engine
