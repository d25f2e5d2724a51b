#pragma once

#include "filasofia/engine/rupture/cut_surface.h"

#include <optional>
#include <span>
#include <vector>

namespace filasofia::engine {

/// A straight piece of a blade, where it is and where it was a step ago. A blade is any number of them: a line, a
/// strip, the two jaws of scissors. Where one begins where the last ended they are one edge, which should bend there by
/// no more than 45 degrees: around a sharper corner bridges stay. Two cuts one after the other, each a mean edge beyond
/// the corner, come apart.
struct BladeSegment {
    Vec3 from = {};       ///< [m]
    Vec3 to = {};         ///< [m]
    Vec3 fromBefore = {}; ///< [m]
    Vec3 toBefore = {};   ///< [m]
};

/// Why the blade cannot be used on a body with this diagonal [m]; nothing where it can. Segments without length are
/// passed over where others have some.
std::optional<RuptureRefusal> refusalOf(std::span<const BladeSegment> blade, double diagonal);

/// Finds the edges that a blade goes through. Keeps a list of those near it, renewed when blade and tissue have moved
/// by as much as the list reaches, so that a step looks at a few hundred edges.
class CrossingFinder {
public:
    /// Crossings of this step, at most one per edge. A crossing is where the volume spanned by edge and segment changes
    /// its sign between the step's start and its end (zero counts as positive), so that adjacent segments and steps
    /// leave no gap; large steps are looked at in parts.
    void find(const EditableMesh& mesh, std::span<const BladeSegment> blade, std::vector<Crossing>& crossings);
    /// The mesh was edited along these crossings: the edges of its new nodes come in.
    void addEdgesOfNewNodes(const EditableMesh& mesh);
    /// Is no edge near the blade, as of the last find()?
    [[nodiscard]] bool away() const { return edges_.empty(); }

private:
    using Edge = std::array<int, 2>;
    void refresh(const EditableMesh& mesh, std::span<const BladeSegment> blade, double motion);
    [[nodiscard]] bool follows(const EditableMesh& mesh, std::span<const BladeSegment> blade) const;
    void learnDirections(const EditableMesh& mesh, std::span<const BladeSegment> blade);

    std::vector<Edge> edges_;        ///< ascending
    double margin_ = 0.0;            ///< [m] what the list reaches
    double left_ = -1.0;             ///< [m] of it; negative: to be renewed
    int nodes_ = 0, tetrahedra_ = 0; ///< of the mesh, when the list was right
    std::vector<long> seen_;         ///< per node, the last one that was asked about it: scratch
    long stamp_ = 0;
    std::vector<long> near_; ///< per node, the last pass in which its edges were looked at: scratch
    long pass_ = 0;
    long moves_ = 0;                 ///< of the mesh, at the last step
    std::vector<BladeSegment> last_; ///< the blade at the last step
    std::vector<Vec3> directions_;   ///< [m] per segment: the way it went of late, as a line without sign
};

} // namespace filasofia::engine
