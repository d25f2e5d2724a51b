#pragma once

#include "filasofia/runtime/timing.h"

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

/// What the benches share. Each measures, prints a table, holds it against its limits and returns all of it as JSON.
namespace filasofia::app {

/// One limit of the project, held against what was measured.
struct Verdict {
    std::string limit = {};       ///< what is asked
    std::optional<bool> met = {}; ///< nothing where nothing was measured that says anything about it
    std::string measured = {};    ///< the worst case, in words
};

/// Prints them, a line each.
nlohmann::json printVerdicts(const std::vector<Verdict>& verdicts);

nlohmann::json spreadToJson(const runtime::Spread& spread);

/// Cut to so many decimals: 10 for one, 100 for two.
double rounded(double value, double digits);

/// The paper's table of tetrahedra x subdivision; `seconds` [s] of wall time per cell; `quick` leaves the smallest mesh
/// only.
nlohmann::json benchBunny(double seconds, bool quick);

/// A step's cost by size, time step and threads, against what it costs at least and against the double-precision
/// reference; `quick` leaves the small meshes and fewer steps.
nlohmann::json benchSolver(bool quick);

/// A step's cost with bodies that touch, detection and response apart, against the step of the same bodies going
/// through each other; `quick` leaves the smallest meshes and fewer steps.
nlohmann::json benchContact(bool quick);

/// What a step's cutting costs, by stages, while a blade goes through a block at 5 cm/s; iterations of the solver
/// before, during and after. `quick` leaves a small block.
nlohmann::json benchCut(bool quick);

/// How evenly a haptic servo ticks beside physics, `seconds` [s] of wall time per run; when it lets go of the hand
/// where physics stands still; what energy it gives. `quick` leaves fewer walls.
nlohmann::json benchHaptics(double seconds, bool quick);

/// What the picture costs the main thread, for 5,000 and 50,000 vertices that move in every frame; how long new
/// triangles take; what is left of physics beside a picture. `quick` leaves the smaller surface and fewer frames.
nlohmann::json benchVisual(bool quick);

/// What lasts: a tool that presses, scrapes and grasps the bunny at random for so many simulated minutes, a soft ball
/// on a floor for as long, up to 10, and a tower of boxes for up to 1.
nlohmann::json soakContact(double minutes, int seed);

} // namespace filasofia::app
