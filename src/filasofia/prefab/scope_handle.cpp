#include "filasofia/prefab/scope_handle.h"

#include "filasofia/prefab/handle_body.h"
#include "filasofia/prefab/scope_tip.h"

#include <algorithm>
#include <cmath>

namespace filasofia::prefab {
namespace {

constexpr double kLever = 0.2; ///< [m], from the fulcrum to the handle if the tip is at the fulcrum

} // namespace

ScopeHandle::ScopeHandle(runtime::Simulation& simulation, const ScopeHandsDef& def)
    : simulation_(simulation), def_(def), hand_(def.start)
{
    depth_ = def.start.depth;
    body_ = addHandleBody(simulation, "scope handle",
                          {def.fulcrum - (kLever - depth_) * def.start.aim, tipOf(def, def.start).orientation});
}

ScopeHand ScopeHandle::hand(const frame::Frame& now)
{
    const frame::RigidBodyFrame* handle = now.rigidBody(body_);
    if (handle == nullptr) return hand_;
    const Vec3 inwards = def_.fulcrum - handle->poses[0].position;
    const double far = length(inwards);
    if (far < 0.25 * kLever) return hand_; // pushed through the fulcrum: it has no direction
    hand_.aim = (1.0 / far) * inwards;
    const double depth = kLever - far, moved = depth - depth_;
    depth_ = depth;
    double& goes = clutched_ ? hand_.reach : hand_.depth;
    goes += moved;
    hand_.depth = std::clamp(hand_.depth, def_.leastDepth, def_.mostDepth);
    hand_.reach = std::clamp(hand_.reach, def_.leastReach, def_.mostReach);
    ScopeHand unrolled = hand_;
    unrolled.roll = 0.0;
    hand_.roll = rollBetween(tipOf(def_, unrolled).orientation, handle->poses[0].orientation);
    return hand_;
}

void ScopeHandle::feel(const frame::Frame& now, BodyId scope, BodyId instrument) const
{
    const frame::RigidBodyFrame* handle = now.rigidBody(body_);
    if (handle == nullptr) return;
    const auto isTool = [&](BodyId id) { return id == scope || id == instrument; };
    const Vec3 inwards = def_.fulcrum - handle->poses[0].position;
    const double lever = length(inwards);
    if (lever == 0.0) return;
    const Vec3 aim = (1.0 / lever) * inwards;
    // Virtual work: if the handle moves across the aim by d, a point s beyond the fulcrum moves by -d s / lever.
    Vec3 force = {}, torque = {};
    const auto add = [&](Vec3 onTool, Vec3 point) {
        const Vec3 arm = point - def_.fulcrum;
        const Vec3 along = dot(onTool, aim) * aim;
        force += along - (dot(arm, aim) / lever) * (onTool - along);
        torque += dot(cross(arm, onTool), aim) * aim;
    };
    for (const frame::Contact& contact : now.contacts)
        if (isTool(contact.first) != isTool(contact.second))
            add(forceOn(isTool(contact.first) ? contact.first : contact.second, contact), contact.point);
    // Held tissue is between the jaws, which are some millimetres long.
    if (const frame::RigidBodyFrame* jaws = now.rigidBody(instrument))
        add(frame::forceOn(instrument, now.attachments), jaws->poses.back().position);
    pushHandleBody(simulation_, body_, force, torque);
}

} // namespace filasofia::prefab
