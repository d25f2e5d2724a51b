#pragma once

#include "filasofia/engine/rupture/open_faces.h"
#include "filasofia/math/mat3.h"

#include <span>
#include <vector>

namespace filasofia::engine {

/// When and how much a mesh tears.
struct TearParameters {
    double threshold = 0.0; ///< [Pa], > 0: an element tears if its largest principal stress exceeds this
    int mostTears = 4;      ///< [-], >= 1, tears per step; the rest follows in the next
    int mostTries = 8;      ///< [-], >= 1, attempts per step: many nodes cannot open because of their neighbours
    int patience = 50;      ///< [steps] before a node that could not open is tried again, unless another one opens
};

/// A node that a tear went through.
struct Tear {
    int node = 0;
    double stress = 0.0; ///< [Pa] largest principal stress, averaged over the node's elements
    Vec3 place = {};     ///< [m] current position
    Vec3 direction = {}; ///< unit, across the tear
};

/// Tears a mesh if the stress of its elements is too high. At the node with the largest average, the elements around it
/// separate along the faces between those ahead of it and those behind it in the direction of the stress. Nothing is
/// bisected or deleted. Two tears of one step share no element, because each tear changes the stress around it.
class Tearing {
public:
    /// `stresses`: Cauchy stress, one per tetrahedron [Pa]. `held`: one per node, nonzero for nodes that do not tear
    /// (pinned ones, whose stress is high by construction); may be empty.
    RuptureReport step(EditableMesh& mesh, std::span<const Mat3> stresses, std::span<const std::uint8_t> held,
                       const TearParameters& parameters);
    [[nodiscard]] const std::vector<Tear>& torn() const { return torn_; } ///< tears of the last step

private:
    void findCandidates(const EditableMesh& mesh, std::span<const Mat3> stresses, std::span<const std::uint8_t> held,
                        double threshold);

    std::vector<Tear> torn_, candidates_;
    std::vector<long> notBefore_; ///< per node: first step in which it may be tried again
    long step_ = 0;
};

/// Tears through `node`, across `direction` (in the current positions), without looking at the stress. Returns true if
/// it opened; if not, the mesh is unchanged.
bool tearAt(EditableMesh& mesh, int node, Vec3 direction, RuptureReport& report);

} // namespace filasofia::engine
