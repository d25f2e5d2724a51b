#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/physics/step.h"

namespace filasofia {
class WorkerPool;
}

namespace filasofia::engine {

/// Which stresses are looked for.
struct StressSearch {
    double threshold = 0.0;                       ///< [Pa]
    const SpringsOfElements& springs;             ///< mass-spring bodies only
    std::span<const std::uint16_t> stressed = {}; ///< per block of sixteen elements, bits of those that may be at
                                                  ///< kStressNear of the threshold; empty: all may
};

/// Cauchy's stress of every element, as it is now [Pa]. Those that cannot be above `threshold` may be zero instead:
/// most of a body is nowhere near it. Springs have the virial one. True where one is above.
bool findStresses(const SoftModel& model, const SoftState& state, const StressSearch& search, WorkerPool& pool,
                  std::vector<Mat3>& stresses);

/// The rotation of the step's start is near enough to tell what is as far as this from tearing.
inline constexpr double kStressNear = 0.5;

/// Opens what the stress tears, so much of it as a step may.
void tearBody(SoftBody& body, WorkerPool& pool, physics::TopologyReport& report);

/// Which springs the elements of a mass-spring body have, and how many elements each spring.
SpringsOfElements springsOfElements(const SoftModel& model);

} // namespace filasofia::engine
