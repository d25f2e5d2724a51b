#pragma once

#include "filasofia/device/haptic_servo.h"

#include <string>
#include <vector>

/// What `bench haptics` measures.
namespace filasofia::app {

/// A ball in a scripted hand that pokes a wall twice a second, live: the servo on its thread beside physics on its own.
struct ServoScene {
    std::string name = {};
    double physicsRate = 1000.0; ///< [Hz]
    double seconds = 10.0;       ///< [s] of wall time
    double stall = 0.0;          ///< [s] that physics stands still, once, in the middle of a poke; 0: never
};

struct ServoTimes {
    ServoScene scene = {};
    device::ServoStatistics servo = {};
    double mostForce = 0.0;  ///< [N] on the hand
    double zeroAfter = 0.0;  ///< [s] from the stall's beginning to the first tick without force
    double zeroWithin = 0.0; ///< [s] the watchdog's time
    int pushesInStall = 0;   ///< ticks with a force after that, while physics still stood
    double ramp = 0.0;       ///< [N] the largest change of the force from one tick to the next after the stall
    double others = 0.0;     ///< [-] cores that other programs took
};

ServoTimes timeServo(const ServoScene& scene);
/// A thread of the same priority that does nothing but wake, alone: how even the machine itself is.
ServoTimes timeClock(double seconds);

/// A hand that pokes a wall for 20 s on a clock of its own making: no machine's speed is in it.
struct WallEnergy {
    double physicsRate = 1000.0; ///< [Hz]
    double stiffness = 0.0;      ///< [N/m] of the coupling, against a wall that does not yield
    double jitter = 0.0;         ///< [s] by which ticks are late, at random
    double most = 0.0;           ///< [J] net energy given to the hand, at its highest
    double given = 0.0;          ///< [J] that the hand had given, at its highest
    double force = 0.0;          ///< [N] the largest
};

WallEnergy pokeWall(double physicsRate, double stiffness, double jitter);

} // namespace filasofia::app
