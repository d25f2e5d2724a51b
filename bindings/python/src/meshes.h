#pragma once

#include "where.h"

#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <memory>

namespace filasofia::python {

/// A mesh as Python holds it: shared with the simulations that use it, and never changed.
template <class Mesh> struct SharedMesh {
    std::shared_ptr<const Mesh> mesh;
};
template <class Mesh> inline constexpr const char* kMeshName = nullptr;
template <> inline constexpr const char* kMeshName<geometry::TetMesh> = "TetMesh";
template <> inline constexpr const char* kMeshName<geometry::TriangleMesh> = "TriangleMesh";

/// TetMesh, TriangleMesh, the shapes and the readers of mesh files.
void bindMeshes(nb::module_& module);

} // namespace filasofia::python
