#pragma once

#include "filasofia/device/haptic_servo.h"

#include <string>
#include <vector>

/// The runs of `bench haptics`.
namespace filasofia::app {

/// A ball in a scripted hand pokes a wall twice a second, in real time: the servo and physics each run on their own
/// thread.
struct ServoScene {
    std::string name = {};
    double physicsRate = 1000.0; ///< [Hz]
    double seconds = 10.0;       ///< [s] wall time of the run
    double stall = 0.0;          ///< [s] length of the one stall of physics, in the middle of a poke; 0 for none
};

struct ServoTimes {
    ServoScene scene = {};
    device::ServoStatistics servo = {};
    double maxForce = 0.0;   ///< [N] largest force on the hand
    double zeroAfter = 0.0;  ///< [s] from the stall's beginning to the first tick without force
    double zeroWithin = 0.0; ///< [s] the watchdog's time limit
    int pushesInStall = 0;   ///< [-] ticks with a force after that, while physics still stalls
    double ramp = 0.0;       ///< [N] the largest change of the force from one tick to the next after the stall
    double others = 0.0;     ///< [-] cores used by other programs
};

ServoTimes timeServo(const ServoScene& scene);
/// A thread of the same priority that only wakes up, with nothing beside it: how even the machine itself is.
ServoTimes timeClock(double seconds);

/// A hand that pokes a wall for 20 s on a simulated clock, so that the machine's speed has no influence.
struct WallEnergy {
    double physicsRate = 1000.0; ///< [Hz]
    double stiffness = 0.0;      ///< [N/m] stiffness of the virtual coupling, against a rigid wall
    double jitter = 0.0;         ///< [s] largest random delay of a tick
    double netEnergy = 0.0;      ///< [J] net energy given to the hand, at its highest
    double handWork = 0.0;       ///< [J] energy that the hand has put in, at its highest
    double force = 0.0;          ///< [N] the largest force
};

WallEnergy pokeWall(double physicsRate, double stiffness, double jitter);

} // namespace filasofia::app
