#pragma once

#include "filasofia/engine/collision/collision_shape.h"
#include "filasofia/engine/collision/inset.h"
#include "filasofia/geometry/embedding.h"
#include "filasofia/physics/defs.h"

#include <memory>
#include <span>
#include <vector>

namespace filasofia::engine {

/// One way in which a body is touched: a surface, and how its vertices ride on the body.
struct CollisionModel {
    /// Of a soft body at rest in the world; of a rigid one in its element's coordinates.
    std::shared_ptr<const CollisionShape> shape;
    Inset inset;
    std::vector<Vec3> core;   ///< [m] of a rigid body: the shape's vertices, moved inwards
    double proximity = 0.0;   ///< [m] of the surface itself
    int element = 0;          ///< of a rigid body
    std::vector<int> behind;  ///< of a soft body's own surface: per triangle, the fourth node of its tetrahedron
    geometry::Embedding ties; ///< of a soft body: per vertex, its nodes and their weights
};

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
