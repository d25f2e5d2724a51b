#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/physics/commands.h"

namespace filasofia::engine {

struct BuiltSoftBody final : physics::BuiltBody {
    SoftBody body;
    [[nodiscard]] int nodeCount() const override { return static_cast<int>(body.model.rest.size()); }
};

struct BuiltRigidBody final : physics::BuiltBody {
    RigidBody body;
    [[nodiscard]] int nodeCount() const override { return static_cast<int>(body.model.rest.size()); }
};

/// From what was asked to what can be stepped, by steps of about `period` [s]; throws an Error that names body, field,
/// bound and value.
std::unique_ptr<physics::BuiltBody> buildBody(const physics::BodyDef& def, double period);

} // namespace filasofia::engine
