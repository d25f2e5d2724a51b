#pragma once

#include "filasofia/engine/elastic/element_rotations.h"
#include "filasofia/math/mat3.h"
#include "filasofia/physics/fem_material.h"

#include <array>
#include <cstddef>
#include <span>

/// Quasi-linear viscoelasticity (physics::FemMaterial). With the law's stress T in the frame that turns with an
/// element, each term of the Prony series holds a stress Q_i that decays, and grows with T. If T changes at a constant
/// rate during a step h, exactly (Simo and Hughes 1998, 10.3):
///     Q_i' = d_i Q_i + c_i (T' - T),   d_i = exp(-h / tau_i),   c_i = share_i (1 - d_i) tau_i / h
/// The stress is share_0 T + sum Q_i, where share_0 is what never relaxes. T is Biot's stress, relative to mu.
namespace filasofia::engine {

using physics::kMostPronyTerms;
constexpr std::size_t kSymmetric = 6; ///< entries of a symmetric matrix: 00 01 02 11 12 22

/// The stresses of sixteen elements side by side. State: it persists from step to step.
struct alignas(64) ElementRelaxation {
    float stress[kSymmetric][kElementsPerBlock] = {};                 ///< [-] T / mu at the last update
    float terms[kMostPronyTerms][kSymmetric][kElementsPerBlock] = {}; ///< [-] Q_i / mu
};

/// d_i and c_i of a step.
struct PronyFactors {
    std::array<double, kMostPronyTerms> decay{}, gain{};
};
PronyFactors pronyFactors(std::span<const physics::PronyTerm> terms, double dt);

/// What a step needs of the series.
struct RelaxationStep {
    std::size_t terms = 0; ///< none: the tissue does not relax
    PronyFactors past;     ///< of the last step, for the update of the terms
    PronyFactors ahead;    ///< of this step
    double present = 1.0;  ///< [-] share_0
    double tangent = 1.0;  ///< [-] dT_total / dT within this step: share_0 + sum c_i
};
/// `past` [s]: the last step; 0 if the terms are up to date. `dt` [s]: this step; 0 for an explicit one, which uses the
/// present stress.
RelaxationStep relaxationStep(std::span<const physics::PronyTerm> terms, double past, double dt);

/// The share of a body's stress that a step of this length carries into its matrix; 1 without relaxation.
double relaxationTangent(std::span<const physics::PronyTerm> terms, double dt);

/// Updates the terms of an element to its law's stress T [-], relative to mu, at the start of a step. Returns the
/// stress
/// [-] that it would have at the end of the step if T stayed.
Mat3 updateRelaxation(const RelaxationStep& step, const Mat3& stress, std::size_t lane, ElementRelaxation& state);

/// [-] The stress at the end of the step, with the law's stress T there. The state is that of the step's start.
Mat3 relaxedStress(const RelaxationStep& step, const Mat3& stress, std::size_t lane, const ElementRelaxation& state);

/// Gives an element the stresses of another.
void copyRelaxation(std::size_t from, std::size_t to, std::span<ElementRelaxation> all);

} // namespace filasofia::engine
