#include "filasofia/sofa/told_joints.h"

#include <algorithm>
#include <cmath>

namespace filasofia::sofaengine {

using physics::JointDef;

ToldJoints::ToldJoints(const physics::RigidBodyDef& def) : def_(def)
{
    def_.elements.resize(1); // the base
    for (const JointDef& each : def_.articulation.joints) starts_.push_back(each.start);
    rewind();
}

void ToldJoints::rewind()
{
    state_ = {};
    for (std::size_t j = 0; j < starts_.size(); ++j) {
        state_.joints.push_back({.position = starts_[j]});
        const auto& command = def_.articulation.joints[j].command;
        const auto* told = command ? std::get_if<physics::JointPosition>(&*command) : nullptr;
        state_.targets.push_back(told ? told->value : starts_[j]);
    }
}

void ToldJoints::setTarget(int joint, double position) { state_.targets[static_cast<std::size_t>(joint)] = position; }

std::vector<Pose> ToldJoints::move(double dt, const Pose& base)
{
    for (std::size_t j = 0; j < state_.joints.size(); ++j) {
        JointDef& def = def_.articulation.joints[j];
        frame::Joint& joint = state_.joints[j];
        const double end = std::clamp(state_.targets[j], def.lower, def.upper);
        const double way = std::clamp(end - joint.position, -def.speed * dt, def.speed * dt);
        def.start = std::abs(end - joint.position) <= def.speed * dt ? end : joint.position + way;
        joint = {.position = def.start, .velocity = way / dt};
    }
    def_.elements[0] = base;
    return physics::elementPoses(def_);
}

/// Whether a joint moves an element, itself or through other joints.
bool ToldJoints::moves(std::size_t joint, int element) const
{
    const std::vector<JointDef>& joints = def_.articulation.joints;
    while (element != 0) { // towards the base: a tree without loops
        const auto mover = std::ranges::find(joints, element, &JointDef::child);
        if (mover == joints.begin() + static_cast<std::ptrdiff_t>(joint)) return true;
        element = mover->parent;
    }
    return false;
}

void ToldJoints::load(std::span<const PointForce> forces, std::span<const Pose> poses)
{
    for (std::size_t j = 0; j < state_.joints.size(); ++j) {
        const JointDef& def = def_.articulation.joints[j];
        const Pose place = poses[static_cast<std::size_t>(def.parent)] * def.parentOffset;
        const Vec3 axis = rotate(place.orientation, normalized(def.axis));
        double load = 0.0;
        for (const PointForce& each : forces) {
            if (!moves(j, each.element)) continue;
            const bool turns = def.kind == physics::JointKind::Revolute;
            load += dot(axis, turns ? cross(each.point - place.position, each.force) : each.force);
        }
        state_.joints[j].load = load;
        state_.joints[j].force = -load; // what its motion takes
    }
}

} // namespace filasofia::sofaengine
