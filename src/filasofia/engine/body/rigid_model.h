#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/engine/articulation/link_motion.h"
#include "filasofia/engine/body/channel.h"
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
    LinkTree tree;                               ///< empty if the body has no joints
    std::vector<physics::JointCommand> commands; ///< per joint: the command at the start
    BodyId to; ///< the body that carries the base; none: the base is kinematic, or free if the body is dynamic
    int toElement = 0;
    Pose offset; ///< pose of the base in that element's coordinates
};

/// The properties of a rigid body, dynamic or kinematic (its motion is prescribed).
struct RigidModel {
    BodyId id;
    std::string name;
    std::vector<Pose> rest; ///< per element: its pose when it was added
    /// Per element; zero unless the body is dynamic or the element is a link with mass.
    std::vector<physics::RigidInertia> inertias;
    bool dynamic = false;
    bool gravity = true;
    double linearDamping = 0.0;  ///< [1/s]
    double angularDamping = 0.0; ///< [1/s]
    double friction = 0.0;       ///< [-] mu
    Vec3 startVelocity;          ///< [m/s] velocity of the centres of mass; with joints, of the base's origin
    Vec3 startAngularVelocity;   ///< [rad/s] in world axes; with joints, of the base
    std::vector<CollisionModel> collision;
    std::shared_ptr<const geometry::TriangleMesh> surface; ///< in the element's coordinates; may be null
    ArticulationModel articulation;                        ///< joints between its elements
    std::optional<Needle> needle;                          ///< none: it pierces nothing
};

/// The state of a joint: its command, its motion, and the forces with which the next solve starts.
struct JointState {
    physics::JointCommand command;
    frame::Joint now;             ///< as frames carry it
    double lowerLimitForce = 0.0; ///< [N m] or [N] warm start of the lower limit
    double upperLimitForce = 0.0; ///< [N m] or [N] warm start of the upper limit
    double frictionForce = 0.0;   ///< [N m] or [N] warm start of dry friction
};

/// A virtual coupling (Colgate): a spring and a damper between a haptic target and an element.
struct ElementCoupling {
    int element = 0;
    physics::HapticTarget target;
};

/// Poses, velocities and loads of a rigid body, all per element. The velocities of a kinematic body say how it moved in
/// the last step; inside the engine they only enter the inertial forces on its joints.
struct RigidState {
    std::vector<Pose> poses;
    /// [m/s] velocity of the centre of mass, or of the origin if the element is a link or kinematic.
    std::vector<Vec3> velocities;
    std::vector<Vec3> angularVelocities; ///< [rad/s] in world axes
    std::vector<Wrench> wrenches;        ///< set by the user; zero unless the body is dynamic
    /// The pose that an element of a kinematic body gets at the end of the coming step; none: it stays where it is.
    std::vector<std::optional<Pose>> targets;
    std::vector<JointState> joints;
    std::vector<ElementCoupling> couplings = {}; ///< virtual couplings, ascending by element; empty unless dynamic
    bool cutting = true;                         ///< its blades cut; otherwise they touch what they would cut
    /// [-] More than 0 for blades that were switched off inside tissue, until they are out (elements_at.h).
    int sheath = 0;
};

/// The state at the start, with the start's velocities and no wrenches.
RigidState stateAtStart(const RigidModel& model);

/// Throws an Error that names the body if a size, an index or a number is invalid.
void check(const RigidModel& model, const RigidState& state);

} // namespace filasofia::engine
