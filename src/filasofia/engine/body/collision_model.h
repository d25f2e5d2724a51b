#pragma once

#include "filasofia/engine/collision/collision_shape.h"
#include "filasofia/engine/collision/inset.h"
#include "filasofia/geometry/embedding.h"
#include "filasofia/physics/defs.h"

#include <memory>
#include <span>
#include <vector>

namespace filasofia::engine {

/// A surface by which a body collides, and how its vertices follow the body.
struct CollisionModel {
    /// Soft body: at rest, in world coordinates; rigid body: in its element's coordinates.
    std::shared_ptr<const CollisionShape> shape;
    Inset inset;
    std::vector<Vec3> core;    ///< [m] the shape's vertices, moved inwards; rigid bodies only
    double proximity = 0.0;    ///< [m] proximity of the surface itself, without the inset
    double ownProximity = 0.0; ///< [m] the same of a solid against itself
    /// [m] Its features stand for all that is so near to them: a rod's tube, a rigid ball or capsule, a shell as thick
    /// as twice that. 0: its triangles are the surface.
    double round = 0.0;
    int element = 0;          ///< rigid bodies only
    bool own = false;         ///< soft bodies only: it is the body's own surface, and follows its cuts
    bool selfOnceCut = false; ///< own surfaces only: once cut, it collides with itself
    /// Per triangle: the fourth node of its tetrahedron; only of an own surface, and not of a shell.
    std::vector<int> behind;
    geometry::Embedding embedding; ///< per vertex: its nodes and their weights; soft bodies only
};

/// Builds the collision models of a body and loads their meshes. Throws an Error that names the body and the field.
std::vector<CollisionModel> buildCollision(const physics::SoftBodyDef& def, const geometry::TetMesh& worldMesh);
/// For a shell: its triangles are its surface.
std::vector<CollisionModel> buildCollision(const physics::SoftBodyDef& def, const geometry::TriangleMesh& worldShell);
/// For a rod: the tube around its nodes.
std::vector<CollisionModel> buildCollision(const physics::RodBodyDef& def, const std::vector<Vec3>& nodes);
/// The models of meshes that stand for balls or capsules come twice: as they are, for tissue, and, after all others, as
/// the exact ones, for what is rigid. Not blades, nor if only some primitives collide.
std::vector<CollisionModel> buildCollision(const physics::RigidBodyDef& def);

/// The collision model of a rod that has these segments left; `lone` vertices belong to none of them.
CollisionModel cutCollision(const CollisionModel& whole, std::vector<std::array<int, 2>> segments,
                            std::vector<int> lone);

/// [m] The largest depth by which vertices of a surface are moved inwards.
double insetDepth(double proximity);

/// Sets the distances at which contacts are looked for in a shape of this model. The inset moves the surface inwards,
/// so they grow by its largest depth; if there is no inset, as on a sheet, they are those of the model.
void setProximity(const CollisionModel& model, CollisionShape& shape);

/// Appends vertices that coincide with nodes.
void addToEmbedding(std::span<const int> nodes, geometry::Embedding& embedding);

} // namespace filasofia::engine
