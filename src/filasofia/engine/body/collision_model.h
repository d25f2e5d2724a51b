#pragma once

#include "filasofia/engine/body/model.h"

namespace filasofia::engine {

/// The collision models of a body; the Defs' meshes are loaded. Throws an Error naming the body and the field.
std::vector<CollisionModel> buildCollision(const physics::SoftBodyDef& def, const geometry::TetMesh& worldMesh);
std::vector<CollisionModel> buildCollision(const physics::RigidBodyDef& def);

/// [m] How far in the vertices of a surface go at most.
double insetDepth(double proximity);

/// What is left of a surface lies deeper by what was taken off, and contacts are looked for from as much farther on;
/// where nothing was taken off, as of a sheet, from where the proximity says.
void setProximity(double proximity, const Inset& inset, CollisionShape& shape);

/// Vertices that are nodes.
void addTies(std::span<const int> nodes, geometry::Embedding& ties);

} // namespace filasofia::engine
