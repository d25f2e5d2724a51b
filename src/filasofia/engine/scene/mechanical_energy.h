#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/physics/mechanical_energy.h"

namespace filasofia::engine {

/// The energy of a body as it is now. Removed pieces have none.
physics::MechanicalEnergy mechanicalEnergy(const SoftBody& body, Vec3 gravity);
physics::MechanicalEnergy mechanicalEnergy(const RigidBody& body, Vec3 gravity);

} // namespace filasofia::engine
