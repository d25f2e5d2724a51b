#pragma once

#include "filasofia/physics/defs.h"
#include "filasofia/physics/haptic_target.h"

#include "filasofia/core/attachment_id.h"
#include "filasofia/core/body_id.h"

#include <functional>

/// The only way into a running simulation: applied at the start of the next step, in the order of posting.
namespace filasofia::physics {

class PhysicsEngine;

/// A finished body, as its engine keeps it: built and checked on the caller's thread, moved in at a step's start.
class BuiltBody {
public:
    virtual ~BuiltBody() = default;
    [[nodiscard]] virtual int nodeCount() const = 0; ///< nodes of a soft body, elements of a rigid one
};

struct AddBody {
    BodyId id = {};
    std::shared_ptr<const BodyDef> def = {};
    std::unique_ptr<BuiltBody> body = {};
    AttachmentId attachments = {}; ///< the first of those of its Def, the others follow; none: it has none
};
/// And every attachment to it.
struct RemoveBody {
    BodyId id = {};
};
/// Where a rigid element is told to be: at the end of the step, or, where the body is dynamic, at once and at rest.
struct SetPose {
    BodyId id = {};
    int element = 0;
    Pose pose = {}; ///< its orientation of any length > 1e-6: the engine makes it unit
};
/// What pushes an element of a dynamic body at its centre of mass, in place of what did.
struct SetWrench {
    BodyId id = {};
    int element = 0;
    Vec3 force = {};  ///< [N], in world axes
    Vec3 torque = {}; ///< [N m], in world axes
};
/// What a joint of an articulated body does from now on: goes to a position, or is pushed.
struct SetJoint {
    BodyId id = {};
    int joint = 0; ///< [-], in the order of its Def
    JointCommand command = {};
};
/// Where the hand is that holds an element. A dynamic body is pulled there by the coupling until told anew, and without
/// any stiffness and damping it is let go; one with joints cannot be held. Any other goes there in the step and stays,
/// as with SetPose, whatever the coupling.
struct SetHaptic {
    BodyId id = {};
    int element = 0;
    HapticTarget target = {};
};
struct SetGravity {
    Vec3 gravity = {}; ///< [m/s^2]
};
struct SetMaterial {
    BodyId id = {};
    SoftMaterial material = {};
    /// The body built anew with it, of which the engine takes what depends on the material, and leaves behind what it
    /// had. None (in a replay): the step makes that.
    std::unique_ptr<BuiltBody> body = {};
};
/// Replaces all given forces of a soft body.
struct SetForces {
    BodyId id = {};
    std::vector<NodalForce> forces = {};
};
struct SetPressure {
    BodyId id = {};
    double pressure = 0.0; ///< [Pa]
};
/// Holds nodes of a soft body where they are at the start of the step.
struct Attach {
    AttachmentId id = {};
    BodyId body = {};
    AttachmentDef def = {};
};
/// The same for a rigid body.
struct AttachRigid {
    AttachmentId id = {};
    BodyId body = {};
    RigidAttachmentDef def = {};
};
/// Nothing happens where it has broken, or its body is gone.
struct Release {
    AttachmentId id = {};
};
/// Takes a piece that cuts or tears have set loose out of the scene. Nothing happens where there is none of this
/// number, or where it is all that is left of the body; the step then counts it in TopologyReport::noPiece.
struct RemovePiece {
    BodyId id = {};
    int piece = 0; ///< as LoosePiece names it; 0: what kept the body's place
};
/// Ties to a rigid body what it touches of the target in the step; while paused, in the first that goes on.
struct Grasp {
    AttachmentId id = {};
    BodyId rigid = {};
    BodyId target = {};
    GraspDef def = {};
};
/// Every body back to where it was added, with the velocities it was added with; time and step count go on. Attachments
/// stay as they are now.
struct Reset {};
/// While paused, steps apply commands and nothing moves.
struct Pause {
    bool paused = true;
};
/// Runs once between two steps with the engine itself in hand; see filasofia/engine/native/native.h.
struct Tune {
    std::function<void(PhysicsEngine&)> change;
};

// For recordings: what a command says. A built body is no part of it: it is built again from the Def.
constexpr auto fields(const AddBody*)
{
    return describe("AddBody", field("id", &AddBody::id, "the body to be"),
                    field("def", &AddBody::def, "what it is made from"),
                    field("attachments", &AddBody::attachments, "the first of its Def's"));
}
constexpr auto fields(const RemoveBody*) { return describe("RemoveBody", field("id", &RemoveBody::id, "the body")); }
constexpr auto fields(const SetPose*)
{
    return describe("SetPose", field("id", &SetPose::id, "the rigid body"),
                    field("element", &SetPose::element, "-", nonNegative(), "of its elements"),
                    field("pose", &SetPose::pose, "where it is from now on"));
}
constexpr auto fields(const SetWrench*)
{
    return describe("SetWrench", field("id", &SetWrench::id, "the dynamic body"),
                    field("element", &SetWrench::element, "-", nonNegative(), "of its elements"),
                    field("force", &SetWrench::force, "N", finite(), "at its centre of mass"),
                    field("torque", &SetWrench::torque, "N m", finite(), "in world axes"));
}
constexpr auto fields(const SetJoint*)
{
    return describe("SetJoint", field("id", &SetJoint::id, "the articulated body"),
                    field("joint", &SetJoint::joint, "-", nonNegative(), "of its joints"),
                    field("command", &SetJoint::command, "where it goes, or what pushes it"));
}
constexpr auto fields(const SetHaptic*)
{
    return describe("SetHaptic", field("id", &SetHaptic::id, "the rigid body"),
                    field("element", &SetHaptic::element, "-", nonNegative(), "of its elements"),
                    field("target", &SetHaptic::target, "the hand that holds it"));
}
constexpr auto fields(const SetGravity*)
{
    return describe("SetGravity", field("gravity", &SetGravity::gravity, "m/s^2", finite(), "acts on every body"));
}
constexpr auto fields(const SetMaterial*)
{
    return describe("SetMaterial", field("id", &SetMaterial::id, "the soft body"),
                    field("material", &SetMaterial::material, "of the kind it was made with"));
}
constexpr auto fields(const SetForces*)
{
    return describe("SetForces", field("id", &SetForces::id, "the soft body"),
                    field("forces", &SetForces::forces, "in place of those it had"));
}
constexpr auto fields(const SetPressure*)
{
    return describe("SetPressure", field("id", &SetPressure::id, "the soft body"),
                    field("pressure", &SetPressure::pressure, "Pa", finite(), "positive pushes inwards"));
}
constexpr auto fields(const Attach*)
{
    return describe("Attach", field("id", &Attach::id, "the attachment to be"),
                    field("body", &Attach::body, "the soft body"), field("def", &Attach::def, "what is held, and how"));
}
constexpr auto fields(const AttachRigid*)
{
    using T = AttachRigid;
    return describe("AttachRigid", field("id", &T::id, "the attachment to be"),
                    field("body", &T::body, "the rigid body"), field("def", &T::def, "what is held, and how"));
}
constexpr auto fields(const Release*) { return describe("Release", field("id", &Release::id, "the attachment")); }
constexpr auto fields(const RemovePiece*)
{
    return describe("RemovePiece", field("id", &RemovePiece::id, "a soft body"),
                    field("piece", &RemovePiece::piece, "-", nonNegative(), "which of its pieces"));
}
constexpr auto fields(const Grasp*)
{
    return describe(
        "Grasp", field("id", &Grasp::id, "the attachment to be"), field("rigid", &Grasp::rigid, "the body that grasps"),
        field("target", &Grasp::target, "the body that is grasped"), field("def", &Grasp::def, "how firmly"));
}
constexpr auto fields(const Reset*) { return describe("Reset"); }
constexpr auto fields(const Pause*) { return describe("Pause", field("paused", &Pause::paused, "or going on")); }
constexpr auto fields(const Tune*) { return describe("Tune"); } // a function cannot be written down

using Command = std::variant<AddBody, RemoveBody, SetPose, SetGravity, SetMaterial, SetForces, SetPressure, SetWrench,
                             Attach, AttachRigid, Release, Grasp, RemovePiece, Reset, Pause, Tune, SetJoint, SetHaptic>;

} // namespace filasofia::physics
