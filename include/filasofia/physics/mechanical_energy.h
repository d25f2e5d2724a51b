#pragma once

namespace filasofia::physics {

/// The mechanical energy of a body between two steps.
struct MechanicalEnergy {
    double kinetic = 0.0; ///< [J] of what has a mass; what is told its motion has none
    /// [J] What strain stores, by the law of the tissue, with its fibres; zero of rigid bodies. Without what terms that
    /// relax hold, what attachments and contacts store, and the work of pressures
    double elastic = 0.0;
    double gravitational = 0.0; ///< [J] zero with all mass at the world's origin, and if no gravity acts on the body
};

} // namespace filasofia::physics
