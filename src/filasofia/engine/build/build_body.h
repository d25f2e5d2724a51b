#pragma once

#include "filasofia/engine/body/body_topology.h"
#include "filasofia/physics/commands.h"

namespace filasofia::engine {

struct BuiltSoftBody final : physics::BuiltBody {
    SoftModel model;
    SoftState state;
    SoftSystem system;
    BodyTopology topology;
    [[nodiscard]] int nodeCount() const override { return static_cast<int>(model.rest.size()); }
};

struct BuiltRigidBody final : physics::BuiltBody {
    RigidModel model;
    RigidState state;
    [[nodiscard]] int nodeCount() const override { return static_cast<int>(model.rest.size()); }
};

/// The same for a rigid body.
std::unique_ptr<physics::BuiltBody> buildRigid(const physics::RigidBodyDef& def);

/// From what was asked to what can be stepped, by steps of about `period` [s]; throws an Error that names body, field,
/// bound and value.
std::unique_ptr<physics::BuiltBody> buildBody(const physics::BodyDef& def, double period);

/// Writes a material into every element or spring of a body that was made with one of the same kind.
void setMaterial(const physics::SoftMaterial& material, SoftModel& model);

/// Replaces the given forces.
void setForces(const std::vector<physics::NodalForce>& forces, SoftState& state);

} // namespace filasofia::engine
