#pragma once

#include "filasofia/engine/soft/assembled_system.h"

namespace filasofia::engine {

/// Adds forces, K v and the matrix of a shell's triangles, if the body is one.
void addShell(const SoftModel& model, ImplicitWeights weights, const SoftState& state, AssembledSystem& system);

} // namespace filasofia::engine
