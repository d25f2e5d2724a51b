#pragma once

#include "filasofia/engine/model.h"

namespace filasofia::engine {

/// The collision models of a body; the Defs' meshes are loaded. Throws an Error naming the body and the field.
std::vector<CollisionModel> buildCollision(const physics::SoftBodyDef& def, const geometry::TetMesh& worldMesh);
std::vector<CollisionModel> buildCollision(const physics::RigidBodyDef& def);

/// The model of a soft body's own surface that an edit has changed: `mesh` at rest, the node of every vertex, and per
/// triangle the fourth node of its tetrahedron.
void remakeOwnSurface(const geometry::TriangleMesh& mesh, const std::vector<int>& nodes, std::vector<int> behind,
                      CollisionModel& model);

} // namespace filasofia::engine
