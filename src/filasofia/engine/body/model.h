#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/engine/articulation/link_tree.h"
#include "filasofia/engine/body/attachment.h"
#include "filasofia/engine/body/pins.h"
#include "filasofia/engine/collision/inset.h"
#include "filasofia/engine/collision/side_kept.h"
#include "filasofia/engine/elastic/corotational.h"
#include "filasofia/engine/elastic/element_rotations.h"
#include "filasofia/engine/elastic/spring.h"
#include "filasofia/frame/attachment.h"
#include "filasofia/frame/contact.h"
#include "filasofia/frame/joint.h"
#include "filasofia/geometry/embedding.h"
#include "filasofia/geometry/triangle_mesh.h"
#include "filasofia/physics/defs.h"
#include "filasofia/physics/haptic_target.h"

#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

/// What the engine knows. The model says what the bodies are and changes only between steps; the state says where they
/// are. Same order of bodies in both, by rising id. Seen from outside only through native.h.
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

/// One of the pieces that a cut body has fallen into.
struct BodyPiece {
    int number = 0;            ///< as physics::LoosePiece tells it
    std::vector<int> nodes;    ///< ascending
    std::vector<int> elements; ///< ascending; of a crumb, else none
    bool held = false;         ///< pins hold some of its nodes
};

/// What a soft body is.
struct SoftModel {
    BodyId id;
    std::string name;
    std::vector<Vec3> rest;                        ///< [m] nodes at the start, in world coordinates
    std::vector<double> masses;                    ///< [kg] lumped, a quarter of each tetrahedron to each node
    std::vector<FemElement> elements;              ///< of a FEM body, neighbours near each other in the list
    std::vector<Spring> springs;                   ///< of a mass-spring body
    std::vector<geometry::Tetrahedron> tetrahedra; ///< of a mass-spring body; a FEM body has elements
    std::vector<geometry::Triangle> surface;       ///< boundary, by nodes, outwards: where pressure acts
    Pins pins;
    physics::Rayleigh rayleigh;
    physics::Integrator integrator;
    physics::Solver solver;
    bool gravity = true;
    double friction = 0.0; ///< [-] mu
    std::vector<CollisionModel> collision;
    bool dynamicTopology = false;  ///< it may be cut and tear
    std::vector<BodyPiece> pieces; ///< by rising number; none while it is whole
    std::set<int> removed;         ///< pieces that were taken out: their nodes are held, and have no surface
    double density = 0.0;          ///< [kg/m^3] what its elements weigh, where they change
    double tearingThreshold = std::numeric_limits<double>::infinity(); ///< [Pa]
};

/// Whether blades of a collision group may cut a body.
bool mayBeCut(const SoftModel& model, int group);

/// Where a soft body is, and what pushes it. All per node unless said.
struct SoftState {
    std::vector<Vec3> x;  ///< [m]
    std::vector<Vec3> v;  ///< [m/s]
    std::vector<Vec3> dv; ///< [m/s] the last step's change: where the next solve starts
    std::vector<ElementRotations>
        rotations;              ///< of sixteen elements each, the last step's: where the next search starts
    std::vector<Vec3> leftover; ///< [N s] the impulse that the last solve left undone, due in the next step
    std::vector<Vec3> forces;   ///< [N] given
    double pressure = 0.0;      ///< [Pa] given
};

/// The joints between the elements of a rigid body: element i is link i, and element 0 the base.
struct ArticulationModel {
    LinkTree tree;                               ///< without joints: there are none
    std::vector<physics::JointCommand> commands; ///< per joint: at the start
    BodyId to;                                   ///< takes the base along; none: it goes where it is told
    int toElement = 0;
    Pose offset; ///< of the base, in that element's coordinates
};

/// What a rigid body is: moved by forces, or going where it is told.
struct RigidModel {
    BodyId id;
    std::string name;
    std::vector<Pose> rest;                      ///< per element: where it was added
    std::vector<physics::RigidInertia> inertias; ///< per element; zeros unless dynamic, or a link that has a mass
    bool dynamic = false;
    bool gravity = true;
    double linearDamping = 0.0;  ///< [1/s]
    double angularDamping = 0.0; ///< [1/s]
    double friction = 0.0;       ///< [-] mu
    Vec3 startVelocity;          ///< [m/s] of the centres of mass; with joints, of the base's origin
    Vec3 startAngularVelocity;   ///< [rad/s] in world axes; with joints, of the base
    std::vector<CollisionModel> collision;
    std::shared_ptr<const geometry::TriangleMesh> surface; ///< in the element's coordinates; may be none
    ArticulationModel articulation;                        ///< joints between its elements
};

/// What a contact did in the last step: where its next solve starts.
struct ContactMemory {
    BodyId first, second;      ///< the bodies
    std::uint64_t feature = 0; ///< which of their features: the same from step to step (collision/proximity.h)
    Vec3 point;                ///< [m] where it was
    Vec3 force;                ///< [N] on the first
};

/// What pushes a rigid element at its centre of mass, in world axes.
struct Wrench {
    Vec3 force;  ///< [N]
    Vec3 torque; ///< [N m]
    friend constexpr bool operator==(const Wrench&, const Wrench&) = default;
};

/// A joint: where it is, what it was told, what the last step's solve leaves for the next.
struct JointState {
    physics::JointCommand command;
    frame::Joint now;       ///< as everyone outside sees it
    double lowerStop = 0.0; ///< [N m] or [N]: where the solve starts, of its limits and of dry friction
    double upperStop = 0.0;
    double dry = 0.0;
};

/// A hand that holds an element.
struct Hand {
    int element = 0;
    physics::HapticTarget target;
};

/// Where a rigid body is, and what pushes it. All per element. The velocities of one that is not dynamic say how it
/// moved in the last step, and nothing follows from them but how its joints are shaken.
struct RigidState {
    std::vector<Pose> poses;
    std::vector<Vec3> velocities;        ///< [m/s] of the centre of mass; of the origin of a link, and of one that is
                                         ///< not dynamic
    std::vector<Vec3> angularVelocities; ///< [rad/s] in world axes
    std::vector<Wrench> wrenches;        ///< given; zero unless dynamic
    /// Where an element of a body that is not dynamic was told to be at the end of the coming step; none: it stays.
    std::vector<std::optional<Pose>> targets;
    std::vector<JointState> joints;
    std::vector<Hand> hands = {}; ///< of those that are held, ascending by element; none unless dynamic
};

struct Model {
    std::vector<SoftModel> softBodies;
    std::vector<RigidModel> rigidBodies;
};

struct State {
    std::uint64_t step = 0;
    double time = 0.0; ///< [s]
    Vec3 gravity;      ///< [m/s^2]
    std::vector<SoftState> softBodies;
    std::vector<RigidState> rigidBodies;
    std::vector<ContactMemory> contacts;    ///< ascending by bodies and feature
    std::vector<SideKept> sides;            ///< of sheets, ascending
    std::vector<frame::Contact> touching;   ///< the last step's contacts, as everyone outside sees them
    std::vector<Attachment> attachments;    ///< by rising id; those that pins do not make
    std::vector<std::vector<Vec3>> holding; ///< [N] per attachment and pair, on its body: where the next solve starts
    std::vector<PendingGrasp> grasps;       ///< by rising id
    std::vector<frame::Attachment> held;    ///< what attachments did in the last step, as everyone outside sees it
};

/// The rotation of one element.
Quat rotationOf(const std::vector<ElementRotations>& rotations, std::size_t element);
void setRotation(std::vector<ElementRotations>& rotations, std::size_t element, Quat q);

/// The start: at rest, with the given forces.
SoftState stateAtRest(const SoftModel& model);

/// The start, with the start's velocities; nothing pushes.
RigidState stateAtStart(const RigidModel& model);

/// True where every number is finite and within physics::kFarthest.
bool usable(std::span<const Vec3> values);

/// Throws an Error naming the body unless every size, index and number can be stepped with.
void check(const SoftModel& model, const SoftState& state);
void check(const RigidModel& model, const RigidState& state);
/// The same for attachments and grasps, naming what is wrong with them.
void checkAttachments(const Model& model, const State& state);
/// The same for what is kept of contacts from step to step.
void checkMemories(const Model& model, const State& state);

} // namespace filasofia::engine
