#pragma once

#include "filasofia/geometry/triangle_mesh.h"
#include "filasofia/math/mat3.h"

namespace filasofia::geometry {

/// What a body of density 1 inside a closed surface has.
struct MassProperties {
    double volume = 0.0; ///< [m^3]
    Vec3 centre = {};    ///< [m], of mass
    Mat3 inertia = {};   ///< [m^5], about the centre, per density
};

/// Throws an Error naming `name` and an edge's two vertices unless every edge is walked as often in one direction as in
/// the other: the surface then has an inside. The mesh is one that check() accepts.
void checkClosed(const TriangleMesh& mesh, std::string_view name);

/// Of a closed surface [m^3]; negative where it is turned inside out.
double enclosedVolume(const TriangleMesh& mesh);

/// Exact for the polyhedron. The mesh is one that check() accepts. Throws an Error naming `name` where it is not
/// closed, turned inside out, flat, or made of parts of which some are inside out outside the others.
MassProperties massProperties(const TriangleMesh& mesh, std::string_view name);

} // namespace filasofia::geometry
