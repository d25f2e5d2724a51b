#include "filasofia/physics/motion_watch.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::physics {

bool changesScene(const Command& command)
{
    return !std::holds_alternative<SetPose>(command) && !std::holds_alternative<SetHaptic>(command) &&
           !std::holds_alternative<SetJoint>(command) && !std::holds_alternative<SetWrench>(command) &&
           !std::holds_alternative<SetForces>(command) && !std::holds_alternative<SetPressure>(command) &&
           !std::holds_alternative<SetCurvature>(command) && !std::holds_alternative<SetGravity>(command);
}

void addElement(const RigidInertia& inertia, const Pose& pose, Vec3 velocity, Vec3 angularVelocity, Vec3 gravity,
                BodyMotion& motion)
{
    const Vec3 turning = rotate(conjugate(pose.orientation), angularVelocity);
    const double energy = 0.5 * inertia.mass * lengthSquared(velocity) + 0.5 * dot(turning, inertia.inertia * turning);
    if (inertia.mass > 0.0) motion.speed = std::max(motion.speed, std::sqrt(2.0 * energy / inertia.mass));
    motion.kinetic += energy;
    motion.potential -= inertia.mass * dot(gravity, transform(pose, inertia.centre));
}

void MotionWatch::follow(bool driven, double dt, const std::function<std::vector<BodyMotion>()>& motions,
                         StepReport& report)
{
    if (driven) {
        undriven_ = window_ = 0.0;
        sums_.clear();
        before_.clear();
        return;
    }
    if (dt == 0.0) return;
    undriven_ += dt;
    if (undriven_ < kWindow) return;
    add(dt, motions());
    window_ += dt;
    if (window_ >= kWindow) endWindow();
    const Motion* worst = nullptr;
    for (const Motion& each : before_) {
        if (!each.restless) continue;
        ++report.unrest.bodies;
        if (!worst || each.speed2 > worst->speed2) worst = &each;
        if (each.gains >= 3) report.set(StepFlag::EnergyGained);
    }
    if (!worst) return;
    report.set(StepFlag::Restless);
    report.unrest.body = worst->body;
    report.unrest.speed = std::sqrt(worst->speed2);
    report.unrest.undriven = undriven_;
}

void MotionWatch::add(double dt, const std::vector<BodyMotion>& motions)
{
    if (sums_.empty()) sums_.resize(motions.size());
    for (std::size_t b = 0; b < motions.size(); ++b) {
        sums_[b].body = motions[b].body;
        sums_[b].speed2 += dt * motions[b].speed * motions[b].speed;
        sums_[b].kinetic += dt * motions[b].kinetic;
        sums_[b].potential += dt * motions[b].potential;
    }
}

void MotionWatch::endWindow()
{
    for (std::size_t b = 0; b < sums_.size(); ++b) {
        Motion& mean = sums_[b];
        for (double* each : {&mean.speed2, &mean.kinetic, &mean.potential}) *each /= window_;
        if (before_.empty()) continue;
        const Motion& before = before_[b];
        mean.earlier = {before.speed2, before.earlier[0], before.earlier[1]};
        const auto [slowest, fastest] = std::ranges::minmax(mean.earlier);
        mean.restless =
            std::min(mean.speed2, slowest) > kAtRest * kAtRest && mean.speed2 >= kSustained * kSustained * fastest;
        const double gained = mean.kinetic - before.kinetic, fallen = before.potential - mean.potential;
        const bool gains = mean.restless && gained > kGain * before.kinetic && gained > (1.0 + kGain) * fallen;
        mean.gains = gains ? before.gains + 1 : 0;
    }
    before_ = std::exchange(sums_, {});
    window_ = 0.0;
}

} // namespace filasofia::physics
