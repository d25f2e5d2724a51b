#pragma once

#include "filasofia/engine/rupture/cut_surface.h"

#include <optional>
#include <span>
#include <vector>

namespace filasofia::engine {

/// A straight piece of a blade, now and one step ago. A blade is any number of segments: a line, a strip, or the two
/// jaws of scissors. If a segment begins where the previous one ends, the two are one edge. That edge should bend by no
/// more than 45 degrees there: around a sharper corner uncut bridges remain. Two cuts one after the other,
/// each extended by a mean edge beyond the corner, separate the tissue.
struct BladeSegment {
    Vec3 from = {};       ///< [m]
    Vec3 to = {};         ///< [m]
    Vec3 fromBefore = {}; ///< [m]
    Vec3 toBefore = {};   ///< [m]
};

/// An edge before and after a step [m].
struct MovingEdge {
    Vec3 a, b; ///< after it
    Vec3 aBefore, bBefore;
};

/// [-] Where along an edge a segment of a blade crosses it in a step, in [0, 1]; none if it does not. An edge is
/// crossed if the signed volume spanned by both changes its sign, zero counts as positive. Large steps are tested in
/// `parts`.
std::optional<double> crossingOf(const MovingEdge& edge, const BladeSegment& segment, int parts);

/// Says why the blade cannot be used on a body with this diagonal [m]; empty if it can. Segments without length are
/// ignored if others have a length.
std::optional<RuptureRefusal> refusalOf(std::span<const BladeSegment> blade, double diagonal);

/// Finds the edges that a blade crosses. It keeps a list of the edges near the blade and rebuilds it when blade and
/// tissue have moved by as much as the list's margin, so that a step tests only a few hundred edges.
class CrossingFinder {
public:
    /// Appends the crossings of this step, at most one per edge. An edge is crossed if the signed volume spanned by
    /// edge and segment changes its sign between the step's start and its end (zero counts as positive), so that
    /// adjacent segments and steps leave no gap. Large steps are tested in parts.
    void find(const EditableMesh& mesh, std::span<const BladeSegment> blade, std::vector<Crossing>& crossings);
    /// Call this after the mesh was edited along these crossings: adds the edges of the new nodes to the list.
    void addEdgesOfNewNodes(const EditableMesh& mesh);
    /// True if no edge was near the blade at the last find().
    [[nodiscard]] bool away() const { return edges_.empty(); }

private:
    using Edge = std::array<int, 2>;
    void refresh(const EditableMesh& mesh, std::span<const BladeSegment> blade, double motion);
    [[nodiscard]] bool follows(const EditableMesh& mesh, std::span<const BladeSegment> blade) const;
    void learnDirections(const EditableMesh& mesh, std::span<const BladeSegment> blade);

    std::vector<Edge> edges_;        ///< sorted, ascending
    double margin_ = 0.0;            ///< [m] margin of the list around the blade
    double remaining_ = -1.0;        ///< [m] rest of the margin; negative: the list must be rebuilt
    int nodes_ = 0, tetrahedra_ = 0; ///< sizes of the mesh when the list was built
    std::vector<long> seen_;         ///< scratch: per node, the stamp of the last node that visited it
    long stamp_ = 0;
    std::vector<long> near_; ///< scratch: per node, the last pass that visited its edges
    long pass_ = 0;
    long moves_ = 0;                 ///< the mesh's moves() at the last step
    std::vector<BladeSegment> last_; ///< the blade at the last step
    std::vector<Vec3> directions_;   ///< [m] per segment: recent direction of motion, up to its sign
};

} // namespace filasofia::engine
