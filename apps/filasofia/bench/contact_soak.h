#pragma once

#include "apps/filasofia/bench/contact_run.h"

#include <optional>
#include <string>

namespace filasofia::app {

/// What went wrong, how often, and when first [s].
struct Mishap {
    long steps = 0;
    std::optional<double> first = {};
    std::string when = {}; ///< the tools' action at that time
    void add(double time, const std::string& doing);
};

/// The result of a long run.
struct SoakReport {
    std::string scene = {};
    double seconds = 0.0;         ///< [s] simulated
    double wall = 0.0;            ///< [s]
    double proximity = 1e-3;      ///< [m] the sum of both bodies' proximities
    double penetration = 0.0;     ///< [m] the deepest penetration that the engine reports
    double penetratedAt = 0.0;    ///< [s]
    std::string penetrating = {}; ///< the tools' action at that time
    Mishap notFinite = {};        ///< positions or velocities
    Mishap flagged = {};          ///< steps with a flag
    std::uint32_t flags = 0;      ///< the union of all flags
    Mishap through = {};          ///< a tool's axis inside an element of the body
    Mishap inverted = {};         ///< an inverted element while tools act on the body
    long touching = 0;            ///< [-] steps with contacts that push
    int maxPushing = 0;           ///< [-]
    int invertedAtEnd = 0;        ///< [-] elements, after a rest without tools
    double displacedAtEnd = 0.0;  ///< [m] the largest distance of a node, after that rest, from its first rest position
    double lean = 0.0;            ///< [m] the largest motion of a box of the tower
};

/// The bunny of 3004 tetrahedra, pinned at its feet, and the tools of RandomMoves.
SoakReport soakTools(double seconds, int seed);
SoakReport soakBall(double seconds);
SoakReport soakTower(double seconds);

} // namespace filasofia::app
