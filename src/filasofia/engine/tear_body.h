#pragma once

#include "filasofia/engine/topology.h"
#include "filasofia/physics/step.h"

namespace filasofia {
class WorkerPool;
}

namespace filasofia::engine {

/// Cauchy's stress of every element, as it is now [Pa]. Those that cannot be above `threshold` may be zero instead:
/// most of a body is nowhere near it. Springs have the virial one. True where one is above.
bool findStresses(const SoftModel& model, const SoftState& state, double threshold, const SpringsOfElements& springs,
                  WorkerPool& pool, std::vector<Mat3>& stresses);

/// Opens what the stress tears, so much of it as a step may.
void tearBody(const SoftModel& model, const SoftState& state, WorkerPool& pool, BodyTopology& topology,
              physics::TopologyReport& report);

} // namespace filasofia::engine
