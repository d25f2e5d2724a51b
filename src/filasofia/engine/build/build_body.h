#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/physics/commands.h"

namespace filasofia::engine {

/// A soft body that addBody() can move into the scene.
struct BuiltSoftBody final : physics::BuiltBody {
    SoftBody body;
    [[nodiscard]] int nodeCount() const override { return static_cast<int>(body.model.rest.size()); }
};

/// A rigid body that addBody() can move into the scene.
struct BuiltRigidBody final : physics::BuiltBody {
    RigidBody body;
    [[nodiscard]] int nodeCount() const override { return static_cast<int>(body.model.rest.size()); }
};

/// Builds a body from its Def. `period` [s]: the step that its solver prepares for. Throws an Error that names body,
/// field, bound and value if the Def is invalid.
std::unique_ptr<physics::BuiltBody> buildBody(const physics::BodyDef& def, double period);

} // namespace filasofia::engine
