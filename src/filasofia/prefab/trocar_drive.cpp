#include "filasofia/prefab/trocar_drive.h"

#include "filasofia/prefab/handle_body.h"

#include <utility>

namespace filasofia::prefab {
namespace {

DriveDef checked(DriveDef def)
{
    checkTrocar(def.trocar, def.hand, def.start, def.object);
    return def;
}

} // namespace

TrocarDrive::TrocarDrive(runtime::Simulation& simulation, const DriveDef& def)
    : simulation_(simulation), def_(checked(def)), wanted_(def.start), state_{.given = def.start},
      report_(reportOf(def.trocar, def.hand.length, state_, {})), newest_(report_)
{
    if (def.hand.haptic)
        handle_ = addHandleBody(simulation, def.object + " handle", {report_.handle, report_.pivot.orientation});
}

void TrocarDrive::move(const TrocarPose& pose)
{
    if (handle_) fail(def_.object, ": a haptic device moves it, so it must not be told where to go");
    checkLimits(def_.trocar, pose, def_.object);
    turns.take(!simulation_.physics().stepsHere(), [this, pose] { wanted_ = pose; });
}

Pose TrocarDrive::step(double time, BodyId body, Vec3 grip)
{
    // While another thread changes it, the hand rests; the next step makes up for it.
    turns.now([&] {
        advance(time - std::exchange(last_, time), body, grip);
        publish();
    });
    return newest_.read().pivot;
}

void TrocarDrive::advance(double dt, BodyId body, Vec3 grip)
{
    ShaftLoad load;
    if (const frame::FrameRef frame = simulation_.physics().latest()) {
        load = loadOn(*frame, body, grip);
        if (handle_) wanted_ = withinLimits(def_.trocar, fromHandle(*frame));
    }
    prefab::step(def_.trocar, def_.hand, wanted_, load, dt, state_);
    report_ = reportOf(def_.trocar, def_.hand.length, state_, load);
    if (!handle_) return;
    pushHandleBody(simulation_, handle_, report_.force,
                   report_.torque * rotate(report_.pivot.orientation, {0.0, 0.0, -1.0}));
}

/// The pose of the shaft that goes from the handle's body through the fulcrum.
TrocarPose TrocarDrive::fromHandle(const frame::Frame& now) const
{
    const frame::RigidBodyFrame* handle = now.rigidBody(handle_);
    if (handle == nullptr) return wanted_;
    const Vec3 inwards = def_.trocar.fulcrum - handle->poses[0].position;
    const double outside = length(inwards);
    if (outside < 0.1 * def_.hand.length) return wanted_; // pushed through the fulcrum: it has no direction
    TrocarPose pose = poseAt(def_.trocar, def_.trocar.fulcrum + inwards);
    pose.insertion = def_.hand.length - outside;
    pose.roll = rollBetween(pivotOf(def_.trocar, pose).orientation, handle->poses[0].orientation);
    return pose;
}

ShaftLoad TrocarDrive::loadOn(const frame::Frame& now, BodyId body, Vec3 grip) const
{
    ShaftLoad load{.at = def_.trocar.fulcrum};
    const auto add = [&](Vec3 force, Vec3 point) {
        load.force += force;
        load.moment += cross(point - load.at, force);
    };
    for (const frame::Contact& contact : now.contacts)
        if ((contact.first == body) != (contact.second == body)) add(forceOn(body, contact), contact.point);
    add(frame::forceOn(body, now.attachments), grip);
    return load;
}

} // namespace filasofia::prefab
