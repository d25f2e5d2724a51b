#include "filasofia/engine/native/native.h"

#include "filasofia/core/error.h"
#include "filasofia/engine/scene/find_body.h"
#include "filasofia/engine/world.h"
#include "filasofia/physics/physics_server.h"

#include <utility>

namespace filasofia::engine {
namespace {

SoftBody& softOf(Scene& scene, BodyId id)
{
    const auto index = findIn(scene.soft, id);
    if (!index) fail("tune: body ", id.value, ": there is no such soft body");
    return scene.soft[*index];
}

template <class List> auto& entryOf(List& list, const char* what, int index)
{
    if (index < 0 || static_cast<std::size_t>(index) >= list.size())
        fail("tune: ", what, " must be in [0, ", list.size(), "), got ", index);
    return list[static_cast<std::size_t>(index)];
}

} // namespace

Vec3& Native::gravity() { return scene_.gravity; }

std::vector<BodyId> Native::softBodies() const
{
    std::vector<BodyId> ids;
    for (const SoftBody& body : scene_.soft) ids.push_back(body.model.id);
    return ids;
}

std::vector<BodyId> Native::rigidBodies() const
{
    std::vector<BodyId> ids;
    for (const RigidBody& body : scene_.rigid) ids.push_back(body.model.id);
    return ids;
}

NativeSoftBody Native::softBody(BodyId id)
{
    SoftBody& body = softOf(scene_, id);
    return {.id = id,
            .rest = body.model.rest,
            .positions = body.state.x,
            .velocities = body.state.v,
            .velocityChanges = body.state.dv,
            .residuals = body.state.residual,
            .masses = body.model.masses,
            .integrator = body.model.integrator,
            .solver = body.model.solver,
            .rayleigh = body.model.rayleigh};
}

NativeRigidBody Native::rigidBody(BodyId id)
{
    const auto index = findIn(scene_.rigid, id);
    if (!index) fail("tune: body ", id.value, ": there is no such rigid body");
    RigidBody& body = scene_.rigid[*index];
    return {.id = id,
            .poses = body.state.poses,
            .velocities = body.state.velocities,
            .angularVelocities = body.state.angularVelocities,
            .inertias = body.model.inertias};
}

int Native::elementCount(BodyId softBody) const
{
    return static_cast<int>(softOf(scene_, softBody).model.elements.size());
}

NativeElement Native::element(BodyId softBody, int element) const
{
    const FemElement& e = entryOf(softOf(scene_, softBody).model.elements, "element", element);
    return {e.nodes, e.youngModulus, e.poissonRatio};
}

void Native::setElement(BodyId softBody, int element, double youngModulus, double poissonRatio)
{
    FemElement& e = entryOf(softOf(scene_, softBody).model.elements, "element", element);
    e.youngModulus = youngModulus;
    e.poissonRatio = poissonRatio;
}

int Native::springCount(BodyId softBody) const
{
    return static_cast<int>(softOf(scene_, softBody).model.springs.size());
}

NativeSpring Native::spring(BodyId softBody, int spring) const
{
    const Spring& s = entryOf(softOf(scene_, softBody).model.springs, "spring", spring);
    return {s.nodes, s.restLength, s.stiffness, s.damping};
}

void Native::setSpring(BodyId softBody, int spring, const NativeSpring& value)
{
    Spring& s = entryOf(softOf(scene_, softBody).model.springs, "spring", spring);
    s.restLength = value.restLength;
    s.stiffness = value.stiffness;
    s.damping = value.damping;
}

void tune(physics::PhysicsServer& server, std::function<void(Native&)> change)
{
    if (!change) fail("tune: the function to run must not be empty");
    if (!dynamic_cast<const World*>(&server.engine())) fail("tune: the native engine is not in use");
    server.tune([change = std::move(change)](physics::PhysicsEngine& engine) {
        Native native(dynamic_cast<World&>(engine).scene());
        change(native);
    });
}

} // namespace filasofia::engine
