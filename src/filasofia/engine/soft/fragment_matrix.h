#pragma once

#include "filasofia/engine/body/soft_model.h"

#include <vector>

namespace filasofia::engine {

/// The matrix of an implicit step for one small piece, in double. Its nodes are numbered by their places in the piece's
/// list.
struct FragmentMatrix {
    std::vector<double> entries; ///< [kg] three rows and columns per node, row by row
    double mass = 0.0;           ///< [kg] weighed, of all nodes
};

/// dt > 0 [s].
FragmentMatrix fragmentMatrix(const SoftModel& model, const BodyPiece& piece, double dt, const SoftState& state);

} // namespace filasofia::engine
