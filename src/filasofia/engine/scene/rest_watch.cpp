#include "filasofia/engine/scene/rest_watch.h"

#include "filasofia/engine/scene/state_hash.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::engine {
namespace {

using physics::StepFlag;

/// Whether a command changes the scene in a way that hashOfDrive() does not see.
bool changesScene(const physics::Command& command)
{
    return !std::holds_alternative<physics::SetPose>(command) && !std::holds_alternative<physics::SetHaptic>(command) &&
           !std::holds_alternative<physics::SetJoint>(command) &&
           !std::holds_alternative<physics::SetWrench>(command) &&
           !std::holds_alternative<physics::SetForces>(command) &&
           !std::holds_alternative<physics::SetPressure>(command) &&
           !std::holds_alternative<physics::SetCurvature>(command) &&
           !std::holds_alternative<physics::SetGravity>(command);
}

/// [m/s] The root mean square speed of an element that has this energy.
double speedOf(double kinetic, double mass) { return mass > 0.0 ? std::sqrt(2.0 * kinetic / mass) : 0.0; }

} // namespace

void RestWatch::follow(const physics::StepInput& in, const Scene& scene, physics::StepReport& report)
{
    const std::uint64_t drive = hashOfDrive(scene);
    if (std::exchange(drive_, drive) != drive || std::ranges::any_of(in.commands, changesScene) ||
        !report.topology.ruptures.empty()) {
        undriven_ = window_ = 0.0;
        sums_.clear();
        before_.clear();
        return;
    }
    if (in.dt == 0.0) return;
    undriven_ += in.dt;
    if (undriven_ < kWindow) return;
    addMotions(in.dt, scene);
    window_ += in.dt;
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

void RestWatch::addMotions(double dt, const Scene& scene)
{
    std::size_t next = 0;
    const auto add = [&](BodyId body, double speed, double kinetic, double potential) {
        if (next == sums_.size()) sums_.push_back({.body = body});
        Motion& sum = sums_[next++];
        sum.speed2 += dt * speed * speed;
        sum.kinetic += dt * kinetic;
        sum.potential += dt * potential;
    };
    for (const SoftBody& each : scene.soft) {
        double speed2 = 0.0, kinetic = 0.0, potential = 0.0;
        for (std::size_t i = 0; i < each.state.v.size(); ++i) {
            const double square = lengthSquared(each.state.v[i]), mass = each.model.masses[i];
            speed2 = std::max(speed2, square);
            kinetic += 0.5 * mass * square;
            if (each.model.gravity) potential -= mass * dot(scene.gravity, each.state.x[i]);
        }
        add(each.model.id, std::sqrt(speed2), kinetic, potential);
    }
    for (const RigidBody& each : scene.rigid) {
        if (!each.model.dynamic) continue;
        double fastest = 0.0, kinetic = 0.0, potential = 0.0;
        for (std::size_t e = 0; e < each.state.poses.size(); ++e) {
            const physics::RigidInertia& inertia = each.model.inertias[e];
            const Pose& pose = each.state.poses[e];
            const Vec3 turning = rotate(conjugate(pose.orientation), each.state.angularVelocities[e]);
            const double energy = 0.5 * inertia.mass * lengthSquared(each.state.velocities[e]) +
                                  0.5 * dot(turning, inertia.inertia * turning);
            fastest = std::max(fastest, speedOf(energy, inertia.mass));
            kinetic += energy;
            if (each.model.gravity) potential -= inertia.mass * dot(scene.gravity, transform(pose, inertia.centre));
        }
        add(each.model.id, fastest, kinetic, potential);
    }
}

void RestWatch::endWindow()
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

} // namespace filasofia::engine
