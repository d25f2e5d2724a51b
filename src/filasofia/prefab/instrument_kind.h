#pragma once

#include "filasofia/prefab/articulated_instrument.h"

namespace filasofia::prefab {

/// The Def with what its kind has in place of what it does not give: meshes, jaws, closing torque. Throws an Error if
/// it is wrong.
ArticulatedInstrumentDef completed(ArticulatedInstrumentDef def);

/// Whether no mesh is given.
bool isEmpty(const physics::TriangleMeshSource& source);

} // namespace filasofia::prefab
