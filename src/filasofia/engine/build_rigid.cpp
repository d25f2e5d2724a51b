#include "filasofia/engine/build_body.h"
#include "filasofia/engine/build_collision.h"
#include "filasofia/engine/check_collision.h"
#include "filasofia/engine/check_size.h"
#include "filasofia/engine/hand.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::engine {
namespace {

using physics::RigidInertia;

void checkPose(const std::string& object, const Pose& pose)
{
    if (!isFinite(pose)) fail(object, ": poses must be finite");
    if (std::abs(dot(pose.orientation, pose.orientation) - 1.0) > 1e-6)
        fail(object, ": orientation must be a unit quaternion");
}

/// That a step can divide by it, and that some body has it.
void checkInertia(const std::string& object, const RigidInertia& body)
{
    if (!(body.mass > 0.0 && std::isfinite(body.mass) && std::isfinite(1.0 / body.mass)))
        fail(object, ".mass must be > 0 kg, got ", body.mass);
    if (!usable({&body.centre, 1}))
        fail(object, ".centre must lie within ", physics::kFarthest, " m of the element's origin");
    const Mat3& j = body.inertia;
    const double size = trace(j) / 3.0;
    if (!(size > 0.0 && std::isfinite(size) && std::isfinite(1.0 / size)))
        fail(object, ".inertia must be > 0 kg m^2, got ", size, " in the mean");
    constexpr double rounding = 1e-9;
    if (!(frobeniusNorm(j - transpose(j)) < rounding * size)) fail(object, ".inertia must be symmetric");
    // Sylvester's criterion for the inertia and, with rounding's allowance, for the second moments that it is made of.
    constexpr double thinnest = 1e-12;
    const Mat3 one = (1.0 / size) * j, second = (1.5 + rounding) * Mat3::identity() - one;
    const auto least = [](const Mat3& m) {
        return std::min({m[0].x, m[0].x * m[1].y - m[0].y * m[1].x, determinant(m)});
    };
    if (!(least(one) > thinnest))
        fail(object, ".inertia must be > 0 about every axis, and about none of them next to nothing");
    if (!(least(second) > -thinnest)) fail(object, ".inertia: no moment may be more than the sum of the other two");
}

} // namespace

std::unique_ptr<physics::BuiltBody> buildRigid(const physics::RigidBodyDef& def)
{
    const RigidInertia inertia = physics::inertiaOf(def);
    auto built = std::make_unique<BuiltRigidBody>();
    RigidModel& model = built->model;
    model.name = def.name;
    for (std::size_t e = 0; e < def.elements.size(); ++e)
        model.rest.push_back(
            physics::unitPose(def.elements[e], text("rigid body '", def.name, "': elements[", e, "]")));
    model.inertias.assign(model.rest.size(), inertia);
    model.dynamic = def.dynamic;
    model.gravity = def.gravity;
    model.linearDamping = def.linearDamping;
    model.angularDamping = def.angularDamping;
    model.friction = def.friction;
    model.collision = buildCollision(def);
    model.surface = physics::loadMesh(def.mesh, text("rigid body '", def.name, "': mesh"));
    model.startVelocity = def.velocity;
    model.startAngularVelocity = def.angularVelocity;
    built->state = stateAtStart(model);
    check(model, built->state);
    return built;
}

RigidState stateAtStart(const RigidModel& model)
{
    const std::size_t count = model.rest.size();
    const auto start = [&](Vec3 v) { return std::vector<Vec3>(count, model.dynamic ? v : Vec3{}); };
    return {.poses = model.rest,
            .velocities = start(model.startVelocity),
            .angularVelocities = start(model.startAngularVelocity),
            .wrenches = std::vector<Wrench>(count),
            .targets = std::vector<std::optional<Pose>>(count)};
}

void check(const RigidModel& model, const RigidState& state)
{
    const std::string object = text("rigid body '", model.name, "'");
    const std::size_t count = model.rest.size();
    if (count == 0) fail(object, ": elements must have at least one entry");
    checkSize(object, "inertias", model.inertias.size(), count);
    checkSize(object, "poses", state.poses.size(), count);
    checkSize(object, "velocities", state.velocities.size(), count);
    checkSize(object, "angularVelocities", state.angularVelocities.size(), count);
    checkSize(object, "wrenches", state.wrenches.size(), count);
    checkSize(object, "targets", state.targets.size(), count);
    for (const auto& [field, value] : {std::pair{"linearDamping", model.linearDamping},
                                       {"angularDamping", model.angularDamping},
                                       {"friction", model.friction}})
        if (!nonNegative().contains(value)) fail(object, ": ", field, " must be >= 0, got ", value);
    checkCollision(object, model);
    if (model.surface) geometry::check(*model.surface, object + ": surface");
    const Vec3 start[] = {model.startVelocity, model.startAngularVelocity};
    if (model.dynamic && !(usable(start) && usable(state.velocities) && usable(state.angularVelocities)))
        fail(object, ": velocities must be < ", physics::kFarthest, " m/s and rad/s");

    for (std::size_t e = 0; e < count; ++e) {
        checkPose(object, model.rest[e]);
        checkPose(object, state.poses[e]);
        if (state.targets[e]) checkPose(object, *state.targets[e]);
        if (model.dynamic) checkInertia(text(object, ": inertias[", e, "]"), model.inertias[e]);
        if (model.dynamic && state.targets[e]) fail(object, ": a dynamic body has no targets");
        if (!isFinite(state.wrenches[e].force) || !isFinite(state.wrenches[e].torque))
            fail(object, ": wrenches must be finite");
    }
    checkHands(object, model, state);
}

} // namespace filasofia::engine
