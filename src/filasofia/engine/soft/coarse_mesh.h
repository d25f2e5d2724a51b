#pragma once

#include "filasofia/engine/body/pins.h"
#include "filasofia/engine/soft/coarse_rebuild.h"
#include "filasofia/geometry/coarse_lattice.h"

#include <array>
#include <span>
#include <vector>

/// From which nodes a preconditioner interpolates, and which it solves together, by the mesh alone.
namespace filasofia::engine {

/// The mesh through which the coarse lattice is built.
struct CoarseMesh {
    std::span<const Vec3> rest;
    const std::vector<std::array<int, 2>>& edges;
    std::span<const int> nodes; ///< the nodes that are not pinned hard
    const std::vector<bool>& held;
    const std::vector<PinSpring>& pins;
    const std::vector<double>& masses;
};

/// The coarse lattice of a mesh, and which of its small pieces are free.
struct BuiltLattice {
    geometry::CoarseLattice lattice;
    std::vector<char> freePieces; ///< per small piece: 1 if nothing holds it
};

BuiltLattice buildLattice(const CoarseMesh& mesh, const CoarseChoice& choice);

/// Whether clusters pay off: if the longest edge at a node is more than four times as long as the shortest, at half
/// of the nodes or more. Measured, iterations to 1e-6 without clusters and with them: 217 and 44 for a sheet (5.3), 189
/// and 48 for an artery (4.1), 94 and 50 for a gall bladder (3.8), 29 and 19 for a piece of liver (2.5). The bunny
/// (1.7) takes 5.5 and 4.7 iterations a step, and its steps a seventh more time. With a factor of 3, a body was thrown
/// out of a heap of the contact fuzzer whose bodies were lost in each other (seed 2, scene 235).
bool hasShortEdges(const CoarseMesh& mesh);

/// The clusters of a mesh as a lattice has its small pieces: one coarse node per node, and none else.
geometry::CoarseLattice clusterLattice(const CoarseMesh& mesh, const geometry::CoarseLattice& coarse);

} // namespace filasofia::engine
