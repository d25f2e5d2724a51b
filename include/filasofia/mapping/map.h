#pragma once

#include "filasofia/frame/frame.h"
#include "filasofia/geometry/embedding.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <span>
#include <variant>

/// How the state of a body moves what is drawn of it. Every map is a plain value; applying one is a function.
namespace filasofia::mapping {

/// The drawn thing moves as one with an element of a rigid body.
struct RigidMap {
    int element = 0;
};

/// Each vertex is a node of the soft body.
struct IdentityMap {
    std::vector<int> nodes; ///< per vertex
};

/// Each vertex rides on a tetrahedron of the soft body.
struct BarycentricMap {
    geometry::Embedding embedding;
};

using SoftMap = std::variant<IdentityMap, BarycentricMap>;

/// A surface and how it follows its soft body.
struct MappedSurface {
    geometry::TriangleMesh surface; ///< [m] at rest, in world coordinates
    SoftMap map;
};

/// The body's own boundary: identity.
MappedSurface mapBoundary(const geometry::TetMesh& rest);

/// The part of the boundary of a body under the knife that cuts and tears have opened, or all that was outside from the
/// start: identity. The two share the nodes on the rim between them. May have no triangles.
MappedSurface mapBoundary(const frame::Boundary& boundary, bool opened);

/// A surface given beside the mesh, both in world coordinates: identity where every vertex is the place of a node,
/// else barycentric.
MappedSurface mapSurface(const geometry::TetMesh& rest, geometry::TriangleMesh surface);

/// The surface with its vertices doubled along edges that turn by more than `angle` [rad], so that shading shows them:
/// one vertex for each side of such an edge. Triangles keep their places in the list; uv follow their vertices.
geometry::TriangleMesh withCreases(const geometry::TriangleMesh& surface, double angle);

/// How many nodes a body must have for the map: one more than the highest that it names.
int nodesNeeded(const SoftMap& map);

/// Where the drawn thing is.
Pose apply(const RigidMap& map, const frame::RigidBodyFrame& body);

/// Where the vertices are [m]; `vertices` has one entry per vertex.
void apply(const SoftMap& map, const frame::SoftBodyFrame& body, std::span<Vec3> vertices);

} // namespace filasofia::mapping
