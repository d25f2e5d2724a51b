#pragma once

#include "filasofia/engine/rupture/blade.h"

namespace filasofia::engine {

/// One cut through one mesh, from where the blade enters to where it leaves, in as many steps as it takes. The mesh is
/// whole after each. Any number of strokes may be under way in one mesh, one after another within a step.
class BladeStroke {
public:
    /// `sheet`: mesh.newSheet() for a new surface; that of an earlier stroke to go on with its surface, which then
    /// joins without a bridge.
    explicit BladeStroke(int sheet) : sheet_(sheet) {}

    [[nodiscard]] int sheet() const { return sheet_; }

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

} // namespace filasofia::engine
