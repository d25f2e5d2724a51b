#include "filasofia/engine/scene/rest_watch.h"

#include "filasofia/engine/scene/state_hash.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::engine {
namespace {

using physics::BodyMotion;

BodyMotion motionOf(const SoftBody& body, Vec3 gravity)
{
    double speed2 = 0.0;
    BodyMotion out{.body = body.model.id};
    for (std::size_t i = 0; i < body.state.v.size(); ++i) {
        const double square = lengthSquared(body.state.v[i]), mass = body.model.masses[i];
        speed2 = std::max(speed2, square);
        out.kinetic += 0.5 * mass * square;
        if (body.model.gravity) out.potential -= mass * dot(gravity, body.state.x[i]);
    }
    out.speed = std::sqrt(speed2);
    return out;
}

BodyMotion motionOf(const RigidBody& body, Vec3 gravity)
{
    BodyMotion out{.body = body.model.id};
    for (std::size_t e = 0; e < body.state.poses.size(); ++e)
        addElement(body.model.inertias[e], body.state.poses[e], body.state.velocities[e],
                   body.state.angularVelocities[e], body.model.gravity ? gravity : Vec3{}, out);
    return out;
}

} // namespace

void RestWatch::follow(const physics::StepInput& in, const Scene& scene, physics::StepReport& report)
{
    const std::uint64_t drive = hashOfDrive(scene);
    const bool driven = std::exchange(drive_, drive) != drive ||
                        std::ranges::any_of(in.commands, physics::changesScene) || !report.topology.ruptures.empty();
    const auto motions = [&] {
        std::vector<BodyMotion> all;
        for (const SoftBody& each : scene.soft) all.push_back(motionOf(each, scene.gravity));
        for (const RigidBody& each : scene.rigid)
            if (each.model.dynamic) all.push_back(motionOf(each, scene.gravity));
        return all;
    };
    watch_.follow(driven, in.dt, motions, report);
}

} // namespace filasofia::engine
