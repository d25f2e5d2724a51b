#pragma once

#include "filasofia/geometry/tet_mesh.h"

#include <optional>

namespace filasofia::geometry {

/// The harmonic function on a mesh with the given values at some nodes and no flux through the rest of the surface:
/// Laplace's equation by linear finite elements. One value per node. In a piece of the mesh without a given value it is
/// zero. `given` must have one entry per node.
std::vector<double> harmonicFunction(const TetMesh& mesh, const std::vector<std::optional<double>>& given);

/// The gradient of a function that is linear in each tetrahedron, per tetrahedron [1/m].
std::vector<Vec3> gradients(const TetMesh& mesh, const std::vector<double>& values);

} // namespace filasofia::geometry
