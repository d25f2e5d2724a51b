#pragma once

#include "filasofia/sofa/sofa_scene.h"

#include "filasofia/physics/physics_engine.h"

#include <span>

namespace filasofia::sofaengine {

/// What build() returns: plain data, of which a step makes nodes.
struct PlannedSoft final : physics::BuiltBody {
    SoftPlan plan = {};
    [[nodiscard]] int nodeCount() const override { return static_cast<int>(plan.mesh.nodes.size()); }
};
struct PlannedRigid final : physics::BuiltBody {
    RigidPlan plan = {};
    [[nodiscard]] int nodeCount() const override { return static_cast<int>(plan.def.elements.size()); }
};

/// Throws an Error if the Def is wrong, or if it asks for what this engine lacks.
std::unique_ptr<physics::BuiltBody> planBody(const physics::BodyDef& def);

/// Throws an Error if this engine cannot carry out the command.
void checkCommand(const physics::Command& command, const physics::BodyDef* def);

/// Carries out the commands of a step, in their order. `self`: the engine, for tune(). Never throws: what SOFA refuses
/// is logged, and reported as StepFlag::TuneRejected.
void applyCommands(std::span<physics::Command> commands, physics::PhysicsEngine& self, SofaScene& scene,
                   physics::StepReport& report);

} // namespace filasofia::sofaengine
