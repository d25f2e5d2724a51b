#pragma once

#include "filasofia/engine/body/body_topology.h"
#include "filasofia/physics/step.h"

namespace filasofia {
class WorkerPool;
}

namespace filasofia::engine {

/// Cauchy's stress of every element, as it is now [Pa]. Those that cannot be above `threshold` may be zero instead:
/// most of a body is nowhere near it. Springs have the virial one. True where one is above. `stressed`: per block of
/// sixteen elements bits for those that may be at kStressNear of the threshold with the rotations of the step's start;
/// empty: all may.
bool findStresses(const SoftModel& model, const SoftState& state, double threshold, const SpringsOfElements& springs,
                  std::span<const std::uint16_t> stressed, WorkerPool& pool, std::vector<Mat3>& stresses);

/// The rotation of the step's start is near enough to tell what is as far as this from tearing.
inline constexpr double kStressNear = 0.5;

/// Opens what the stress tears, so much of it as a step may.
void tearBody(const SoftModel& model, const SoftState& state, SoftSystem& system, WorkerPool& pool,
              BodyTopology& topology, physics::TopologyReport& report);

} // namespace filasofia::engine
