#pragma once

#include "filasofia/engine/rupture/open_faces.h"
#include "filasofia/math/mat3.h"

#include <span>
#include <vector>

namespace filasofia::engine {

/// When and how much a mesh tears.
struct TearParameters {
    double threshold = 0.0; ///< [Pa], > 0: an element tears above this largest principal stress
    int mostTears = 4;      ///< [-], >= 1, in one step; the rest follows in the next
    int mostTries = 8;      ///< [-], >= 1, in one step: many a node cannot open as its neighbours are
    int patience = 50;      ///< [-] steps until a node that could not open is tried again, unless something else opens
};

/// A node that a tear went through.
struct Tear {
    int node = 0;
    double stress = 0.0; ///< [Pa] the largest principal one, averaged over its elements
    Vec3 place = {};     ///< [m] as it is now
    Vec3 direction = {}; ///< unit, across the tear
};

/// Tears a mesh where its elements' stress is too high: at the node with the largest average, the elements around it
/// separate along the faces between those ahead and those behind it in the direction of the stress. Nothing is
/// bisected and nothing deleted. Two tears of one step share no element: what one of them opens changes the stress
/// around it.
class Tearing {
public:
    /// `stresses`: Cauchy's, one per tetrahedron [Pa]. `held`: nodes that do not tear (clamped ones, where stress is
    /// high by construction), one per node; may be empty.
    RuptureReport step(EditableMesh& mesh, std::span<const Mat3> stresses, std::span<const std::uint8_t> held,
                       const TearParameters& parameters);
    [[nodiscard]] const std::vector<Tear>& torn() const { return torn_; } ///< in the last step

private:
    void findCandidates(const EditableMesh& mesh, std::span<const Mat3> stresses, std::span<const std::uint8_t> held,
                        double threshold);

    std::vector<Tear> torn_, candidates_;
    std::vector<long> notBefore_; ///< per node: the step from which on it may be tried
    long step_ = 0;
};

/// One tear, without asking why: through `node`, across `direction` (in the mesh as it is now). Whether it opened;
/// where not, the mesh is as it was.
bool tearAt(EditableMesh& mesh, int node, Vec3 direction, RuptureReport& report);

} // namespace filasofia::engine
