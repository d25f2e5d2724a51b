#pragma once

#include "filasofia/geometry/coarse_lattice.h"

namespace filasofia::geometry {

/// Takes coarse nodes out of the interpolation that others nearly replace: if the weights of a coarse node, over all
/// nodes, are a combination of other coarse nodes' up to a tenth of their size. A Galerkin matrix is singular with two
/// coarse nodes that only one node uses. Nodes give what they drop to their other coarse nodes, in proportion; each
/// keeps at least a fifth. The coarse nodes keep their numbers; those that were taken out are used by none.
void dropDependent(CoarseLattice& lattice);

} // namespace filasofia::geometry
