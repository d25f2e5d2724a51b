#pragma once

#include "filasofia/runtime/show.h"

#include "filasofia/mapping/map.h"
#include "filasofia/physics/defs.h"

namespace filasofia::runtime {

/// The surface that was asked for, in the body's coordinates; null if none was.
std::shared_ptr<const geometry::TriangleMesh> loadSurface(const SurfaceSource& source, const std::string& object);

/// Maps a soft body's boundary, or `surface` (in the body's coordinates) unless it is null, onto the body's nodes.
/// Throws an Error that begins with `object` if the body is a shell and a vertex of the surface lies at none of its
/// nodes.
mapping::MappedSurface mapSoft(const physics::SoftBodyDef& body, const geometry::TriangleMesh* surface,
                               const std::string& object);

/// The triangles of a soft body by its nodes, before it is cut.
std::vector<geometry::Triangle> skinOf(const physics::SoftBodyDef& body, const std::string& object);

/// The tube of a rod. Throws an Error that begins with `object` if `surface` is not null: none follows a rod.
mapping::MappedSurface mapRod(const physics::RodBodyDef& body, const geometry::TriangleMesh* surface,
                              const std::string& object);

/// The mesh of a rigid body, ready to be drawn.
geometry::TriangleMesh ownSurface(const physics::RigidBodyDef& body, const ShowDef& def, const std::string& object);

/// What a body looks like if nobody says it.
visual::Material materialOf(const physics::BodyDef& body);
/// What strands look like if nothing else is said: pale and moist.
visual::Material connectiveTissue();

} // namespace filasofia::runtime
