#include "filasofia/scene/rigid_tree.h"

#include "filasofia/core/error.h"

#include <algorithm>
#include <utility>

namespace filasofia::scene {

int RigidTree::add(physics::JointDef joint, const std::string& jointName, const std::string& linkName)
{
    if (links() >= kMostLinks) fail(place.place(), ": ", place.path(), " has more than ", kMostLinks, " links");
    joint.child = static_cast<int>(links());
    def.articulation.joints.push_back(joint);
    jointNames.push_back(jointName);
    linkNames.push_back(linkName);
    inertias.emplace_back();
    massPlaces.emplace_back();
    return joint.child;
}

void RigidTree::addInertia(int link, const physics::RigidInertia& inertia, const Element& from)
{
    const auto at = static_cast<std::size_t>(link);
    if (!(inertia.mass > 0.0)) return;
    inertias[at] = sumOf(inertias[at], inertia);
    massPlaces[at] = from;
}

void RigidTree::resolveMimics(const XmlReader& reader)
{
    std::vector<physics::JointDef>& joints = def.articulation.joints;
    std::vector<const Mimic*> of(joints.size());
    for (const Mimic& each : mimics)
        if (std::exchange(of[each.joint], &each)) reader.refuse(each.at, "moves a joint that another one moves, too");
    for (const Mimic& each : mimics) {
        physics::JointMimic way{.joint = static_cast<int>(each.joint)};
        std::size_t steps = 0;
        for (const Mimic* next = of[each.joint]; next; next = of[static_cast<std::size_t>(way.joint)]) {
            if (++steps > mimics.size()) reader.refuse(each.at, "must not lead back to its own joint");
            way.offset += way.multiplier * next->way.offset;
            way.multiplier *= next->way.multiplier;
            way.joint = next->way.joint;
        }
        joints[each.joint].mimic = way;
        joints[each.joint].command.reset();
        joints[each.joint].start = 0.0;
    }
    for (const Mimic& each : mimics) { // the other one starts where it leaves all of them within their limits
        const auto other = static_cast<std::size_t>(joints[each.joint].mimic->joint);
        const auto [lower, upper] = physics::limitsOf(joints, other);
        if (!(lower <= upper))
            reader.refuse(each.at, text("leaves joint '", jointNames[other],
                                        "' no place: its limits and those of the joints that go with it do not meet"));
        joints[other].start = std::clamp(joints[other].start, lower, upper);
        if (!joints[other].command) continue;
        if (auto* position = std::get_if<physics::JointPosition>(&*joints[other].command))
            position->value = std::clamp(position->value, lower, upper);
    }
}

void keepUnit(Quat& q)
{
    for (double* each : {&q.w, &q.x, &q.y, &q.z}) *each = std::clamp(*each, -1.0, 1.0);
}

SceneBody RigidTree::finish(XmlReader& reader)
{
    resolveMimics(reader);
    for (Pose& each : def.elements) keepUnit(each.orientation);
    for (physics::JointDef& each : def.articulation.joints) {
        keepUnit(each.parentOffset.orientation);
        keepUnit(each.childOffset.orientation);
    }
    const auto given = [&](std::size_t link) {
        const auto found = principal(inertias[link]);
        if (!found)
            reader.refuse(massPlaces[link],
                          "must have principal moments of inertia > 0, none larger than the sum of the "
                          "other two, together with the parts that are fixed to it");
        return *found;
    };
    // A link between two joints of the same body weighs nothing; a drive with a millionth of what it carries keeps its
    // equation of motion regular.
    physics::RigidInertia whole;
    for (const physics::RigidInertia& each : inertias) whole.mass += each.mass;
    if (def.dynamic && inertias[0].mass > 0.0) def.mass = given(0);
    for (physics::JointDef& joint : def.articulation.joints) {
        const auto link = static_cast<std::size_t>(joint.child);
        if (inertias[link].mass > 0.0)
            joint.mass = given(link);
        else if (whole.mass > 0.0) {
            const double little = std::max(1e-6 * whole.mass, 1e-12);
            joint.mass =
                physics::GivenInertia{.mass = little, .moments = {little * 1e-2, little * 1e-2, little * 1e-2}};
        } else if (!(joint.inertia > 0.0) && joint.command && physics::isByForce(*joint.command)) {
            reader.note(
                place, "no mass",
                text("joint '", jointNames[link - 1], "' is held: its robot weighs nothing, so no force can move it"));
            joint.command.reset();
        }
    }
    SceneBody body{.def = def, .show = show};
    body.places.emplace("", place.place());
    return body;
}

std::string Names::take(const std::string& name)
{
    int& count = taken_[name];
    if (++count == 1) return name;
    for (;; ++count) {
        const std::string other = text(name, " ", count);
        if (!taken_.contains(other)) return taken_[other] = 1, other;
    }
}

} // namespace filasofia::scene
