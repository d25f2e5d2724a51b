#pragma once

#include "filasofia/engine/scene/scene.h"

#include <cstdint>

namespace filasofia::engine {

/// A hash of the state: positions, velocities, pressures and edits of soft bodies, the state of rigid bodies, contacts
/// and attachments. The same input gives the same hash at every step, for any number of threads.
std::uint64_t hashOf(const Scene& scene);

/// A hash of what drives the bodies: gravity, forces and pressures of the user, kinematic poses, hands, commands of
/// joints.
std::uint64_t hashOfDrive(const Scene& scene);

} // namespace filasofia::engine
