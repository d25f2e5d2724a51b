#pragma once

#include "filasofia/frame/frame.h"
#include "filasofia/geometry/embedding.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <span>
#include <variant>

/// How the state of a body moves what is drawn of it. Every map is a plain value; applying one is a function.
namespace filasofia::mapping {

/// The drawn object moves rigidly with an element of a rigid body.
struct RigidMap {
    int element = 0;
};

/// Each vertex coincides with a node of the soft body.
struct IdentityMap {
    std::vector<int> nodes; ///< per vertex
};

/// Each vertex is embedded in a tetrahedron of the soft body.
struct BarycentricMap {
    geometry::Embedding embedding;
};

/// The vertices are those of the tube around a rod's centre line, a smooth curve through all of its nodes.
struct TubeMap {
    int nodes = 0;       ///< how many the rod has
    double radius = 0.0; ///< [m]
    bool closed = false; ///< a ring
};

using SoftMap = std::variant<IdentityMap, BarycentricMap, TubeMap>;

/// A surface and the map by which it follows its soft body.
struct MappedSurface {
    geometry::TriangleMesh surface; ///< [m] at rest, in world coordinates
    SoftMap map;
    std::vector<std::uint8_t> rim = {}; ///< per vertex, 1 on the rim of what cuts have opened; empty: nothing is cut
    /// [m], per vertex, where it is in the pattern of a material: a rod's is straight along x, its director along y;
    /// empty: as in `surface`
    std::vector<Vec3> pattern = {};
};

/// The body's own boundary, with an identity map.
MappedSurface mapBoundary(const geometry::TetMesh& rest);

/// A part of the boundary of a body that may be cut, with an identity map: either what cuts and tears have opened, or
/// what was outside from the start. The two parts share the nodes on the rim between them. May have no triangles.
MappedSurface mapBoundary(const frame::Boundary& boundary, bool opened);

/// Maps a surface given in addition to the mesh, both in world coordinates: identity if every vertex is at the position
/// of a node, otherwise barycentric.
MappedSurface mapSurface(const geometry::TetMesh& rest, geometry::TriangleMesh surface);

/// The triangles of a shell, in world coordinates, mapped onto its nodes.
MappedSurface mapSheet(geometry::TriangleMesh rest);

/// Maps a surface given in addition to them. Throws an Error that begins with `object` unless every vertex is at the
/// position of a node.
MappedSurface mapSheet(const geometry::TriangleMesh& rest, geometry::TriangleMesh surface, const std::string& object);

/// The tube around a rod with these nodes, in world coordinates, closed at both ends; or, if the rod is `closed`,
/// around a ring.
MappedSurface mapTube(std::span<const Vec3> nodes, double radius, bool closed = false);

/// The surface with its vertices duplicated along edges with a dihedral angle of more than `angle` [rad], so that
/// shading shows them: one vertex for each side of such an edge. Triangles keep their indices; uv of vertices
/// are copied with them.
geometry::TriangleMesh withCreases(const geometry::TriangleMesh& surface, double angle);

/// The number of nodes that a body needs for the map: one more than the highest node that it names.
int nodesNeeded(const SoftMap& map);

/// The pose of the drawn object.
Pose apply(const RigidMap& map, const frame::RigidBodyFrame& body);

void apply(const TubeMap& map, const frame::SoftBodyFrame& body, std::span<Vec3> vertices);

/// Computes the positions of the vertices [m]; `vertices` has one entry per vertex.
void apply(const SoftMap& map, const frame::SoftBodyFrame& body, std::span<Vec3> vertices);

} // namespace filasofia::mapping
