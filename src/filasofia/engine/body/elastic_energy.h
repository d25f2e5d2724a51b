#pragma once

#include "filasofia/engine/body/soft_model.h"

namespace filasofia::engine {

/// [J] What strain stores in a soft body: tetrahedra by their law, their fibres and the volumes of their nodes,
/// springs, shells by stretching and bending, rods by stretching, bending and twisting. `gone`: per node, whether it
/// belongs to a removed piece, which stores nothing; empty: none does. What terms that relax hold is not in it.
double elasticEnergy(const SoftModel& model, const SoftState& state, const std::vector<bool>& gone = {});

} // namespace filasofia::engine
