#pragma once

#include "filasofia/engine/rupture/blade.h"

namespace filasofia::engine {

/// One cut through one mesh, from where the blade enters to where it leaves, in as many steps as it takes. The mesh is
/// whole after each. Any number of strokes may be under way in one mesh, one after another within a step; where two
/// cross each other in the same elements at the same time bridges stay, since a node belongs to one surface only (a cut
/// across an older one goes through).
class BladeStroke {
public:
    /// `sheet`: mesh.newSheet() for a new surface; that of an earlier stroke to go on with its surface, which then
    /// joins without a bridge.
    explicit BladeStroke(int sheet) : sheet_(sheet) {}

    [[nodiscard]] int sheet() const { return sheet_; }
    /// Nothing of the mesh is near the blade and nothing waits: time to finish().
    [[nodiscard]] bool away() const { return finder_.away() && crossings_.empty(); }

    /// The blade's way during the step in which the mesh moved from previous to current positions. A blade at rest in
    /// moving tissue cuts too. What is wrong with a blade is counted, and the mesh stays as it is.
    RuptureReport step(EditableMesh& mesh, std::span<const BladeSegment> blade, const CutParameters& parameters);

    /// The blade has left: what waits is done, as much of it as one step may; true when nothing is left and all faces
    /// that were put off have had their last try.
    bool finish(EditableMesh& mesh, const CutParameters& parameters, RuptureReport& report);

private:
    int sheet_;
    CrossingFinder finder_;
    std::vector<Crossing> crossings_; ///< also those that wait
};

/// The surface that a blade which comes back should go on with: the newest whose labels lie within a mean edge of the
/// blade, with the blade in its plane (to 30 degrees); 0 where there is none, and a new one should begin. Walks over
/// all nodes: for when a stroke begins.
int sheetAt(const EditableMesh& mesh, std::span<const BladeSegment> blade);

} // namespace filasofia::engine
