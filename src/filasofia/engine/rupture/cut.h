#pragma once

#include "filasofia/engine/rupture/blade.h"

namespace filasofia::engine {

/// One cut through one mesh, from where the blade enters to where it leaves, in any number of steps. The mesh is valid
/// after each step. Several strokes may be active in one mesh, one after another within a step. If two of them cross
/// each other in the same elements at the same time, uncut bridges remain, since a node belongs to one surface only. A
/// cut across an older one goes through.
class BladeStroke {
public:
    /// `sheet` is mesh.newSheet() for a new surface. To continue the surface of an earlier stroke, pass its sheet: the
    /// two then join without a bridge.
    explicit BladeStroke(int sheet) : sheet_(sheet) {}

    [[nodiscard]] int sheet() const { return sheet_; }
    /// True if no edge of the mesh is near the blade and no crossing is pending: time to finish().
    [[nodiscard]] bool away() const { return finder_.away() && crossings_.empty(); }

    /// Cuts along the blade's motion during the step in which the mesh moved from its previous to its current
    /// positions. A blade at rest in moving tissue cuts too. If the blade is invalid, the refusal is counted and the
    /// mesh stays unchanged.
    RuptureReport step(EditableMesh& mesh, std::span<const BladeSegment> blade, const CutParameters& parameters);

    /// Call this after the blade has left: processes pending crossings, at most as many as one step may. Returns true
    /// if none is left and all deferred faces have been tried a last time.
    bool finish(EditableMesh& mesh, const CutParameters& parameters, RuptureReport& report);

private:
    int sheet_;
    CrossingFinder finder_;
    std::vector<Crossing> crossings_; ///< new crossings and pending ones
};

/// Finds the surface that a returning blade should continue: the newest one whose labels lie within a mean edge of the
/// blade, if the blade lies in its plane (within 30 degrees), or nearly all of a blade that bends lies in the surface.
/// Returns 0 if there is none, and a new surface should begin. It visits all nodes, so it is called only when a stroke
/// begins.
int sheetAt(const EditableMesh& mesh, std::span<const BladeSegment> blade);

} // namespace filasofia::engine
