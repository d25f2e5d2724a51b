#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/physics/step.h"

namespace filasofia {
class WorkerPool;
}

namespace filasofia::engine {

/// Parameters of the search for high stress.
struct StressSearch {
    double threshold = 0.0;                       ///< [Pa]
    const SpringsOfElements& springs;             ///< mass-spring bodies only
    std::span<const std::uint16_t> stressed = {}; ///< per block of sixteen elements, bits of those that may be above
                                                  ///< kStressNear of the threshold; empty: all may
};

/// Finds the current Cauchy stress of every element [Pa]. Elements that cannot be above `threshold` may get zero
/// instead, since most of a body is nowhere near it. Springs have the virial stress. Returns true if an element is
/// above the threshold.
bool findStresses(const SoftModel& model, const SoftState& state, const StressSearch& search, WorkerPool& pool,
                  std::vector<Mat3>& stresses);

/// [-] The rotation at the step's start is accurate enough to exclude elements below this fraction of the threshold.
inline constexpr double kStressNear = 0.5;

/// Opens what the stress tears, at most as much as one step may.
void tearBody(SoftBody& body, WorkerPool& pool, physics::TopologyReport& report);

/// Which springs the elements of a mass-spring body have, and how many elements share each spring.
SpringsOfElements springsOfElements(const SoftModel& model);

} // namespace filasofia::engine
