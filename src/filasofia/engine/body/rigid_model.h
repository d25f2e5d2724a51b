#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/engine/articulation/link_tree.h"
#include "filasofia/engine/body/collision_model.h"
#include "filasofia/frame/joint.h"
#include "filasofia/geometry/triangle_mesh.h"
#include "filasofia/physics/defs.h"
#include "filasofia/physics/haptic_target.h"

#include <optional>
#include <string>
#include <vector>

namespace filasofia::engine {

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

/// The start, with the start's velocities; nothing pushes.
RigidState stateAtStart(const RigidModel& model);

/// Throws an Error naming the body unless every size, index and number can be stepped with.
void check(const RigidModel& model, const RigidState& state);

} // namespace filasofia::engine
