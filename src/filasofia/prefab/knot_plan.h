#pragma once

#include "filasofia/math/vec3.h"

#include <vector>

/// Where hands and fingers are while a throw of a knot is made.
///
/// Two ends that only go around each other make no throw: that comes undone by turning back. One end has to go through
/// a loop. So the winding strand is laid across the wound, fingers form loops of it about a line along `across`, and
/// the other end goes along that line through the loops, against the direction in which the first strand is wound.
///
/// The winding strand also leaves behind the other one, which is half a turn more. So the loops begin behind as well:
/// those that began in front would be undone by that half turn. As the strands change sides from throw to throw, each
/// throw is the mirror image of that before: a square knot.
namespace filasofia::prefab {

/// The axes of a knot: unit vectors, each at right angles to the others.
struct KnotFrame {
    Vec3 place = {}, across = {}, up = {}, front = {};
    double loop = 0.0;   ///< [m] radius of the loops
    double pitch = 0.0;  ///< [m] from loop to loop
    double height = 0.0; ///< [m] the loops' axis over the place
    [[nodiscard]] Vec3 at(double x, double y, double z) const { return place + x * across + y * up + z * front; }
};

struct Throw {
    int turns = 1;
    double side = -1.0; ///< 1 or -1 along `across`, where the winding strand is before it
};

constexpr int kFingersPerTurn = 8;

/// [m] Length of the strand from finger to finger.
double fingerStep(const KnotFrame& frame);
/// Where the fingers are, from the winding strand's base to its end, when the loops have this part of their radius.
std::vector<Vec3> loopsOf(const KnotFrame& frame, const Throw& made, double part);
/// The way of the other hand, through the loops to the other side.
std::vector<Vec3> wayThrough(const KnotFrame& frame, const Throw& made);

} // namespace filasofia::prefab
