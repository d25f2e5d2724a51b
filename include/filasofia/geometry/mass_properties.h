#pragma once

#include "filasofia/geometry/triangle_mesh.h"
#include "filasofia/math/mat3.h"

namespace filasofia::geometry {

/// The mass properties of a body of density 1 inside a closed surface.
struct MassProperties {
    double volume = 0.0; ///< [m^3]
    Vec3 centre = {};    ///< [m], the centre of mass
    Mat3 inertia = {};   ///< [m^5], about the centre, per unit of density
};

/// Throws an Error naming `name` and an edge's two vertices unless every edge is traversed as often in one direction as
/// in the other: only then does the surface have an inside. The mesh must pass check().
void checkClosed(const TriangleMesh& mesh, std::string_view name);

/// The volume inside a closed surface [m^3]; negative if the surface is inside out.
double enclosedVolume(const TriangleMesh& mesh);

/// Exact for the polyhedron. The mesh must pass check(). Throws an Error naming `name` if the surface is not closed, is
/// inside out or flat, or consists of parts of which some are inside out and lie outside the others.
MassProperties massProperties(const TriangleMesh& mesh, std::string_view name);

} // namespace filasofia::geometry
