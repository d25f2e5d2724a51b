#pragma once

#include "filasofia/engine/rupture/blade_runs.h"
#include "filasofia/engine/rupture/cut_surface.h"

#include <optional>
#include <span>
#include <vector>

namespace filasofia::engine {

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
    void find(EditableMesh& mesh, std::span<const BladeSegment> blade, std::vector<Crossing>& crossings);
    /// Call this after the mesh was edited along these crossings: adds the edges of the new nodes to the list.
    void addEdgesOfNewNodes(const EditableMesh& mesh);
    /// True if no edge was near the blade at the last find().
    [[nodiscard]] bool away() const { return edges_.empty(); }
    /// As of the last find().
    [[nodiscard]] BladeRuns& runs() { return runs_; }

private:
    using Edge = std::array<int, 2>;
    void refresh(const EditableMesh& mesh, std::span<const BladeSegment> blade, double motion);
    [[nodiscard]] bool follows(const EditableMesh& mesh, std::span<const BladeSegment> blade) const;
    [[nodiscard]] Vec3 tissueMotion(const EditableMesh& mesh) const;
    struct Normals {
        Vec3 own = {};     ///< the segment alone
        Vec3 smooth = {};  ///< with its neighbours' near the joints
        bool bent = false; ///< a joint near by is no part of a round blade
    };
    /// `when`: the fraction of the step, and the parameter along the segment.
    [[nodiscard]] Normals normalsAt(std::span<const BladeSegment> blade, int segment, std::array<double, 2> when,
                                    Vec3 tissue, double meanEdge) const;

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
    BladeRuns runs_;
};

} // namespace filasofia::engine
