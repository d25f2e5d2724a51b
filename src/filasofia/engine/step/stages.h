#pragma once

#include "filasofia/engine/contact/coupling.h"
#include "filasofia/engine/body/body_topology.h"
#include "filasofia/physics/physics_engine.h"

/// The stages of World::step. Each reads what comes first and writes what comes last; World::step only calls them.
namespace filasofia::engine {

/// 1. What the outside asked for. Systems of bodies that it changed are outdated then.
void applyCommands(std::span<physics::Command> commands, physics::PhysicsEngine& self, Model& model, State& state,
                   Systems& systems, Topologies& topologies, physics::StepReport& report);

/// Makes outdated systems anew, each once however many commands changed its body. `period` [s]: the step that they
/// prepare for.
void remakeSystems(const Model& model, double period, Systems& systems);

/// 2. Who touches whom, who holds whom: the links between bodies, with the impulses of the last step. Plans how rigid
/// bodies would move by themselves.
void findContacts(const Model& model, double dt, const physics::ContactMethod& method, const State& state,
                  Coupling& coupling, WorkerPool& pool);

/// The same for attachments, after the contacts' links; first, what waits to be grasped is. Contacts that an attachment
/// holds already go.
void linkAttachments(double dt, const Model& model, State& state, Coupling& coupling, physics::StepReport& report);

/// What attachments did in the step, and pins; those that had to bear too much go.
void keepAttachments(double dt, const Coupling& coupling, const Systems& systems, const Model& model, State& state);

/// What the links did in the step: forces for everyone else, and where their next impulses start.
void keepContacts(double dt, const Coupling& coupling, State& state, physics::StepReport& report);

/// 3. Forces and stiffness at the present state. Rotations are the only part of the state that it brings up to date.
void assemble(const Model& model, double dt, State& state, Systems& systems, WorkerPool& pool);

/// The same for one body, as if its masses were `inertia` times what they are.
void assembleBody(const SoftModel& model, Vec3 gravity, double dt, double inertia, SoftState& state, SoftSystem& system,
                  WorkerPool& pool);

/// 4. New velocities, new positions: of bodies that touch or hold each other together, of the others each by itself. A
/// body whose new state is not finite is put back, at rest, and its step made again with damping; where that fails too
/// it stays where it is. The impulses stay in the links.
void advance(const Model& model, double dt, const physics::StepBudget* budget, const physics::ContactMethod& method,
             Systems& systems, Coupling& coupling, State& state, WorkerPool& pool, physics::StepReport& report);

} // namespace filasofia::engine
