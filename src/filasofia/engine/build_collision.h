#pragma once

#include "filasofia/engine/model.h"

namespace filasofia::engine {

/// The collision models of a body; the Defs' meshes are loaded. Throws an Error naming the body and the field.
std::vector<CollisionModel> buildCollision(const physics::SoftBodyDef& def, const geometry::TetMesh& worldMesh);
std::vector<CollisionModel> buildCollision(const physics::RigidBodyDef& def);

} // namespace filasofia::engine
