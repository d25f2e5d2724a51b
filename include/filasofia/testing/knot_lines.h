#pragma once

#include "filasofia/math/vec3.h"

#include <vector>

/// Centre lines of loose knots, to be pulled tight: no two parts are nearer than the clearance.
namespace filasofia::testing {

/// An overhand knot: a line that winds around itself by so many whole turns, with a loop between.
struct OverhandKnotDef {
    int turns = 1;           ///< [-], >= 1: the unknotting number; 1 is the common overhand knot, a trefoil
    double pitch = 0.02;     ///< [m], > 0, length of a turn
    double loop = 0.01;      ///< [m], > 0, radius of the loop's ends
    double clearance = 1e-3; ///< [m], > 0, between centre lines
    double tail = 0.05;      ///< [m], > 0, length of each end
};
/// From one end to the other along z; the turns are around the origin, the loop lies towards y.
std::vector<Vec3> overhandKnot(const OverhandKnotDef& def);

/// A knot of throws between two threads, or between the ends of one: a surgeon's knot has throws of 2, 1 and 1 turns,
/// each wound the other way than that before.
struct ThrowsDef {
    std::vector<int> turns = {2, 1, 1}; ///< [-], each >= 1
    double length = 4e-3;               ///< [m], > 0, of a throw
    double rise = 1e-3;                 ///< [m], > 0, from throw to throw
    double clearance = 0.3e-3;          ///< [m], > 0, between centre lines
    double standing = 6e-3;             ///< [m], > 0, the part that is loaded, towards -x
    double tail = 6e-3;                 ///< [m], > 0, the free end
};
/// The first thread, from its standing end to its free end. The throws go up along y; the second thread is the same,
/// turned by half a turn about the y axis.
std::vector<Vec3> throwsLine(const ThrowsDef& def);
Vec3 halfTurn(Vec3 p);

} // namespace filasofia::testing
