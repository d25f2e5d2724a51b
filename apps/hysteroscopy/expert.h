#pragma once

#include "apps/hysteroscopy/anatomy.h"

#include <filasofia/prefab/articulated_instrument.h>
#include <filasofia/prefab/endoscope.h>

namespace hysteroscopy {

/// What two hands do: the scope through the canal, the forceps through the scope.
struct Hand {
    filasofia::Vec3 aim = {0, 1, 0}; ///< unit, the direction of the shaft
    double depth = -0.039;           ///< [m], of the tip beyond the fulcrum
    double roll = 0.0;               ///< [rad], of the scope
    double reach = -0.006;           ///< [m], of the forceps out of their channel
};
void apply(const Hand& hand, filasofia::prefab::Endoscope& scope, filasofia::prefab::ArticulatedInstrument& forceps);

enum class Jaws { AsTheyAre, Open, Close, Together };

/// One movement of a planned motion.
struct Move {
    double seconds = 1.0; ///< [s], > 0
    Hand to = {};
    Jaws jaws = Jaws::AsTheyAre; ///< at its beginning
    std::string picture = {};    ///< its name, taken at the end; empty: none
};

/// Enters, looks around, grasps the polyp, tears it off and brings it out.
std::vector<Move> expertMotion(const Patient& patient);
double durationOf(const std::vector<Move>& moves);

/// Where the hands are at a time since the motion's start, and the move under way.
struct Moment {
    Hand hand = {};
    std::size_t move = 0; ///< [-], < how many there are, or that many at the end
};
Moment at(const std::vector<Move>& moves, double time);

} // namespace hysteroscopy
