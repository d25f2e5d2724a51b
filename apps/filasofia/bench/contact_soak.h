#pragma once

#include "apps/filasofia/bench/contact_run.h"

#include <optional>
#include <string>

namespace filasofia::app {

/// What happened, and when first [s].
struct Mishap {
    long steps = 0;
    std::optional<double> first = {};
    std::string when = {}; ///< what the tools were at
    void add(double time, const std::string& doing);
};

/// How a long run went.
struct SoakReport {
    std::string scene = {};
    double seconds = 0.0;         ///< [s] simulated
    double wall = 0.0;            ///< [s]
    double proximity = 1e-3;      ///< [m] the sum of both bodies'
    double penetration = 0.0;     ///< [m] the deepest, as the engine reports it
    double penetratedAt = 0.0;    ///< [s]
    std::string penetrating = {}; ///< what the tools were at then
    Mishap notFinite = {};        ///< positions or velocities
    Mishap flagged = {};          ///< steps with a flag
    std::uint32_t flags = 0;      ///< all of them
    Mishap through = {};          ///< a tool's axis inside an element of the body
    Mishap inverted = {};         ///< an element inside out, while tools are at it
    long touching = 0;            ///< [-] steps with contacts that push
    int mostPushing = 0;          ///< [-]
    int invertedAtEnd = 0;        ///< [-] elements, after a rest without tools
    double displacedAtEnd = 0.0;  ///< [m] the most that a node then is from where it rested at first
    double lean = 0.0;            ///< [m] the most that a box of the tower has moved
};

/// The bunny of 3004 tetrahedra, held at its feet, and the tools of RandomMoves.
SoakReport soakTools(double seconds, int seed);
SoakReport soakBall(double seconds);
SoakReport soakTower(double seconds);

} // namespace filasofia::app
