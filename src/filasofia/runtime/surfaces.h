#pragma once

#include "filasofia/runtime/show.h"

#include "filasofia/mapping/map.h"
#include "filasofia/physics/defs.h"

namespace filasofia::runtime {

/// The surface that was asked for, in the body's coordinates; null where none was.
std::shared_ptr<const geometry::TriangleMesh> loadSurface(const SurfaceSource& source, const std::string& object);

/// A soft body's boundary, or `surface` in its coordinates (unless null), and how it follows.
mapping::MappedSurface mapSoft(const physics::SoftBodyDef& body, const geometry::TriangleMesh* surface);

} // namespace filasofia::runtime
