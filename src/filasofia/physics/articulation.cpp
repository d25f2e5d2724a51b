#include "filasofia/physics/articulation.h"

#include "filasofia/core/validate.h"
#include "filasofia/geometry/mass_properties.h"
#include "filasofia/physics/check_field.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::physics {
namespace {

const char* unitOf(const JointDef& joint) { return joint.kind == JointKind::Revolute ? " rad" : " m"; }

Pose motionOf(const JointDef& joint, double q)
{
    const Vec3 axis = normalized(joint.axis);
    return joint.kind == JointKind::Revolute ? Pose{{}, axisAngle(axis, q)} : Pose{q * axis, {}};
}

/// The joints in an order in which parents come first; shorter than the list if there is a loop.
std::vector<std::size_t> parentsFirst(const std::vector<JointDef>& joints)
{
    std::vector<bool> reached(joints.size() + 1);
    reached[0] = true;
    std::vector<std::size_t> order;
    for (std::size_t before = joints.size() + 1; before != order.size();) {
        before = order.size();
        for (std::size_t j = 0; j < joints.size(); ++j) {
            if (reached[static_cast<std::size_t>(joints[j].child)]) continue;
            if (!reached[static_cast<std::size_t>(joints[j].parent)]) continue;
            reached[static_cast<std::size_t>(joints[j].child)] = true;
            order.push_back(j);
        }
    }
    return order;
}

void checkPosition(const std::vector<JointDef>& joints, std::size_t j, double value, const std::string& field)
{
    const JointLimits limits = limitsOf(joints, j);
    if (value >= limits.lower && value <= limits.upper) return;
    const bool others = limits.lower != joints[j].lower || limits.upper != joints[j].upper;
    fail(field, " must be within its limits ", others ? "and those of the joints that mimic it, " : "", "[",
         limits.lower, ", ", limits.upper, "]", unitOf(joints[j]), ", got ", value);
}

void checkJoint(const std::vector<JointDef>& joints, std::size_t j, const std::string& field)
{
    const JointDef& joint = joints[j];
    const std::size_t links = joints.size() + 1;
    if (!(length(joint.axis) > 1e-6)) fail(field, ".axis must have a length > 1e-06, got ", length(joint.axis));
    checkElement(joint.parent, links, field + ".parent");
    checkElement(joint.child, links, field + ".child");
    if (joint.child == 0) fail(field, ".child must not be 0, the base");
    static_cast<void>(unitPose(joint.parentOffset, field + ".parentOffset"));
    static_cast<void>(unitPose(joint.childOffset, field + ".childOffset"));
    if (!(joint.upper >= joint.lower)) fail(field, ".upper must be >= lower (", joint.lower, "), got ", joint.upper);
    if (!joint.mimic) checkPosition(joints, j, joint.start, field + ".start");
    if (!(std::abs(joint.velocity) < kFarthest))
        fail(field, ".velocity must be in (", -kFarthest, ", ", kFarthest, ")", unitOf(joint), "/s, got ",
             joint.velocity);
    if (joint.velocity != 0.0 && !(joint.command && isByForce(*joint.command)))
        fail(field, ".velocity must be 0", unitOf(joint),
             "/s unless the joint's command is a JointForce (0 lets it move freely) or a JointSpring, got ",
             joint.velocity);
    if (!joint.command) return;
    if (const auto* position = std::get_if<JointPosition>(&*joint.command))
        checkPosition(joints, j, position->value, field + ".command");
}

void checkMimic(const std::vector<JointDef>& joints, std::size_t j, const std::string& field)
{
    const JointDef& joint = joints[j];
    if (!joint.mimic) return;
    checkElement(joint.mimic->joint, joints.size(), field + ".mimic.joint");
    const auto other = static_cast<std::size_t>(joint.mimic->joint);
    if (other == j) fail(field, ".mimic.joint must be another joint, got ", j);
    if (joints[other].mimic) fail(field, ".mimic.joint must be a joint without a mimic, got ", other);
    if (joint.command) fail(field, ".command must not be given with a mimic");
    if (joint.velocity != 0.0)
        fail(field, ".velocity must be 0", unitOf(joint), "/s with a mimic, got ", joint.velocity);
    if (joint.start != 0.0)
        fail(field, ".start must be 0", unitOf(joint), " with a mimic: it starts where joints[", other,
             "] takes it, at ", startOf(joints, j), unitOf(joint), "; got ", joint.start);
}

void checkTree(const std::vector<JointDef>& joints, const std::string& object)
{
    std::vector<int> moves(joints.size() + 1, -1);
    for (std::size_t j = 0; j < joints.size(); ++j) {
        int& mover = moves[static_cast<std::size_t>(joints[j].child)];
        if (mover >= 0)
            fail(object, ".joints[", j, "].child must be the child of one joint only; element ", joints[j].child,
                 " is already the child of joints[", mover, "]");
        mover = static_cast<int>(j);
    }
    const std::vector<std::size_t> order = parentsFirst(joints);
    for (std::size_t j = 0; j < joints.size(); ++j)
        if (std::ranges::count(order, j) == 0)
            fail(object, ".joints[", j,
                 "] must not be part of a loop; no path of joints leads from element 0 to element ", joints[j].child);
}

/// Links that are listed must be in the poses that follow from their joints.
void checkLinks(const RigidBodyDef& def, const std::string& object)
{
    const std::vector<Pose> poses = elementPoses(def);
    constexpr double farthest = 1e-6; // [m], and [-] for the quaternion
    for (std::size_t e = 1; e < def.elements.size(); ++e) {
        const Pose off = inverse(poses[e]) * unitPose(def.elements[e], text(object, ": elements[", e, "]"));
        if (!(length(off.position) <= farthest && std::abs(off.orientation.w) >= 1.0 - farthest * farthest))
            fail(object, ": elements[", e,
                 "] must have the pose that follows from its joint; it is enough to list the base");
    }
}

} // namespace

double startOf(const std::vector<JointDef>& joints, std::size_t j)
{
    const std::optional<JointMimic>& mimic = joints[j].mimic;
    if (!mimic) return joints[j].start;
    return mimic->multiplier * joints[static_cast<std::size_t>(mimic->joint)].start + mimic->offset;
}

JointLimits limitsOf(const std::vector<JointDef>& joints, std::size_t j)
{
    JointLimits limits{joints[j].lower, joints[j].upper};
    for (const JointDef& each : joints) {
        if (!each.mimic || static_cast<std::size_t>(each.mimic->joint) != j || each.mimic->multiplier == 0.0) continue;
        double low = (each.lower - each.mimic->offset) / each.mimic->multiplier;
        double high = (each.upper - each.mimic->offset) / each.mimic->multiplier;
        if (each.mimic->multiplier < 0.0) std::swap(low, high);
        limits.lower = std::max(limits.lower, low);
        limits.upper = std::min(limits.upper, high);
    }
    return limits;
}

std::size_t elementCount(const RigidBodyDef& def)
{
    return def.articulation.joints.empty() ? def.elements.size() : def.articulation.joints.size() + 1;
}

std::vector<Pose> elementPoses(const RigidBodyDef& def)
{
    const std::vector<JointDef>& joints = def.articulation.joints;
    std::vector<Pose> poses = def.elements;
    poses.resize(elementCount(def));
    for (std::size_t j : parentsFirst(joints)) {
        const JointDef& joint = joints[j];
        const Pose to = unitPose(joint.parentOffset, "parentOffset"), from = unitPose(joint.childOffset, "childOffset");
        Pose& child = poses[static_cast<std::size_t>(joint.child)];
        child =
            poses[static_cast<std::size_t>(joint.parent)] * to * motionOf(joint, startOf(joints, j)) * inverse(from);
        child.orientation = normalized(child.orientation);
    }
    return poses;
}

void checkArticulation(const RigidBodyDef& def, const std::string& object)
{
    const std::vector<JointDef>& joints = def.articulation.joints;
    const std::string field = object + ": articulation";
    if (joints.empty()) fail(field, ".joints must have at least one entry if `to` names a body");
    if (def.dynamic && def.articulation.to)
        fail(field, ".to must not name a body, because forces move a dynamic body's base; got body ",
             def.articulation.to.value);
    if (def.elements.size() != 1 && def.elements.size() != joints.size() + 1)
        fail(object, ": elements must have 1 entry (the base) or ", joints.size() + 1, " (one more than joints), got ",
             def.elements.size());
    static_cast<void>(unitPose(def.elements[0], object + ": elements[0]"));
    static_cast<void>(unitPose(def.articulation.offset, field + ".offset"));
    if (!def.articulation.to && def.articulation.toElement != 0)
        fail(field, ".toElement must be 0 if the base follows no body, got ", def.articulation.toElement);
    for (std::size_t j = 0; j < joints.size(); ++j) checkMimic(joints, j, text(field, ".joints[", j, "]"));
    for (std::size_t j = 0; j < joints.size(); ++j) {
        const std::string joint = text(field, ".joints[", j, "]");
        checkJoint(joints, j, joint);
        if (joints[j].mass) check(*joints[j].mass, joint + ".mass");
    }
    checkTree(joints, field);
    checkLinks(def, object);
    const std::vector<RigidInertia> inertias = linkInertias(def);
    for (std::size_t j = 0; j < joints.size(); ++j)
        if (joints[j].command && isByForce(*joints[j].command) &&
            !takesForce(joints[j], inertias[static_cast<std::size_t>(joints[j].child)]))
            fail(field, ".joints[", j,
                 "].command must not be a force without an inertia to move; give the joint a mass or an "
                 "inertia, or the body a mass");
}

bool takesForce(const JointDef& joint, const RigidInertia& child) { return joint.inertia > 0.0 || child.mass > 0.0; }

std::vector<RigidInertia> linkInertias(const RigidBodyDef& def)
{
    RigidInertia every;
    if (const auto* given = std::get_if<GivenInertia>(&def.mass)) {
        every = inertiaOf(*given);
    } else if (isGiven(def.mesh)) {
        try {
            every = inertiaOf(RigidBodyDef{.name = def.name, .mesh = def.mesh, .dynamic = true, .mass = def.mass});
        } catch (const Error&) { // an open surface, such as that of a blade, has no inertia
        }
    }
    std::vector<RigidInertia> inertias(elementCount(def), every);
    for (const JointDef& joint : def.articulation.joints)
        if (joint.mass) inertias[static_cast<std::size_t>(joint.child)] = inertiaOf(*joint.mass);
    return inertias;
}

std::vector<bool> forceable(const BodyDef& def)
{
    std::vector<bool> able;
    const auto* rigid = std::get_if<RigidBodyDef>(&def);
    if (!rigid || rigid->articulation.joints.empty()) return able;
    const std::vector<RigidInertia> inertias = linkInertias(*rigid);
    for (const JointDef& joint : rigid->articulation.joints)
        able.push_back(takesForce(joint, inertias[static_cast<std::size_t>(joint.child)]));
    return able;
}

void checkBase(const Registry& registry, const RigidBodyDef& def)
{
    const ArticulationDef& articulation = def.articulation;
    if (!articulation.to) return;
    const std::string field = text("rigid body '", def.name, "': articulation");
    if (!registry.has(articulation.to)) registry.failMissing(articulation.to, field + ".to: ");
    const Registry::Body& other = registry.find(articulation.to);
    const auto* rigid = std::get_if<RigidBodyDef>(other.def.get());
    if (!rigid || rigid->dynamic) fail(field, ".to must be a kinematic rigid body, got ", describeBody(*other.def));
    checkElement(articulation.toElement, isArticulated(*rigid) ? 1 : static_cast<std::size_t>(other.nodeCount),
                 field + ".toElement");
}

void checkSettable(const Registry& registry, const RigidBodyDef& def, int element)
{
    if (def.articulation.joints.empty()) return;
    if (element != 0)
        fail("rigid body '", def.name, "': element ", element, " is moved by its joint; only the base, ",
             "element 0, can be set");
    if (def.articulation.to && registry.has(def.articulation.to))
        fail("rigid body '", def.name, "': its base follows body ", def.articulation.to.value, " and cannot be set");
}

void checkCommand(const RigidBodyDef& def, const std::vector<bool>& takesForce, const SetJoint& set)
{
    const std::string object = text("rigid body '", def.name, "'");
    const std::vector<JointDef>& joints = def.articulation.joints;
    if (joints.empty()) fail(object, ": joint ", set.joint, ": no such joint; the body has none");
    checkElement(set.joint, joints.size(), object + ": joint");
    const auto place = static_cast<std::size_t>(set.joint);
    const std::string field = text(object, ": joint ", set.joint);
    validate(set, field);
    if (joints[place].mimic) fail(field, ": takes no command: it mimics joint ", joints[place].mimic->joint);
    if (const auto* position = std::get_if<JointPosition>(&set.command))
        checkPosition(joints, place, position->value, field + ": position");
    else if (!takesForce[place])
        fail(field, ": a force needs something that resists: give the joint a mass or an inertia, or the body a mass");
}

} // namespace filasofia::physics
