#pragma once

#include "filasofia/runtime/timing.h"

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

/// Shared by all benches. A bench measures, prints a table, compares the figures with its limits and returns everything
/// as JSON.
namespace filasofia::app {

/// One limit of the project and the result of the comparison.
struct Verdict {
    std::string limit = {};       ///< the limit as a sentence
    std::optional<bool> met = {}; ///< empty if nothing was measured that could decide it
    std::string measured = {};    ///< the worst case, in words
};

/// A figure and what it was measured with, in words.
struct Measured {
    double value = 0.0;
    std::string where = {};
};

/// Whether all figures are at most `bound`. Names each that is not, or the highest; shows them in `unit`.
Verdict atMost(const std::vector<Measured>& figures, double bound, std::string limit, double unit = 1.0);

/// Rounded to four digits.
double fourDigits(double value);

/// Prints one line per verdict.
nlohmann::json printVerdicts(const std::vector<Verdict>& verdicts);

nlohmann::json spreadToJson(const runtime::Spread& spread);

/// Rounds to a number of decimals: `digits` is 10 for one decimal, 100 for two.
double rounded(double value, double digits);

/// The paper's table of tetrahedra x subdivision. Each cell takes `seconds` [s] of wall time. If `quick`, only the
/// smallest mesh is measured.
nlohmann::json benchBunny(double seconds, bool quick);

/// The paper's bunny with the native engine and with another: the cost of a step beside the error against the engine's
/// own converged solution, and how far apart those are. If `quick`, only the smallest mesh is measured, with fewer
/// steps. Throws an Error if the engine cannot be had.
nlohmann::json benchEngines(const std::string& other, bool quick);

/// A step's cost by mesh size, time step and number of threads, compared with a lower bound of the cost and with the
/// double-precision reference solver. If `quick`, only the small meshes are measured, with fewer steps.
nlohmann::json benchSolver(bool quick);

/// A step's cost in processor time by elastic law and mesh size, each law relative to the corotational one, with the
/// error; and by Poisson ratio, relative to 0.45. If `quick`, only the small meshes are measured, with fewer
/// repetitions.
nlohmann::json benchLaws(bool quick);

/// A step's cost with bodies in contact, detection and response apart, relative to a step of the same bodies without
/// contact. If `quick`, only the smallest meshes are measured, with fewer steps. `only`: the scenes whose "body, scene"
/// contains this.
nlohmann::json benchContact(bool quick, const std::string& only);

/// A step's cost of some of these scenes with the native engine and with another, with the number of contacts, the
/// deepest penetration and the forces. If `quick`, with fewer steps. Throws an Error if the engine cannot be had.
nlohmann::json benchContactEngines(const std::string& other, bool quick);

/// A step's cost of rods that hang, lie on a floor and touch themselves (200 and 1,000 nodes), of a stitch, and of a
/// thread that is drawn through 1 to 16 blocks. If `quick`, with fewer steps. `only`: the scenes whose "body, scene"
/// contains this.
nlohmann::json benchRod(bool quick, const std::string& only);

/// The cost of cutting per step, by stages, while a blade moves through a block at 5 cm/s, and the solver's iterations
/// before, during and after the cut. If `quick`, the block is small.
nlohmann::json benchCut(bool quick);

/// How evenly a haptic servo ticks beside physics, with `seconds` [s] of wall time per run; how soon it releases the
/// hand if physics stalls; and how much energy it gives. If `quick`, fewer walls are measured.
nlohmann::json benchHaptics(double seconds, bool quick);

/// The main thread's cost of a picture of 5,000 and 50,000 vertices that move in every frame; the time that new
/// triangles take; and the physics rate beside a picture. If `quick`, only the smaller surface is measured, with fewer
/// frames.
nlohmann::json benchVisual(bool quick);

/// Long runs: a tool presses, scrapes and grasps the bunny at random for `minutes` of simulated time; a soft ball lies
/// on a floor for the same time, at most 10 min; a tower of boxes stands for at most 1 min.
nlohmann::json soakContact(double minutes, int seed);

} // namespace filasofia::app
