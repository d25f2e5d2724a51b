#pragma once

#include "filasofia/prefab/strand_hand.h"

namespace filasofia::prefab {

/// What hands around a place may do in one step.
struct HandStep {
    runtime::Simulation& simulation;
    const frame::Frame& now;
    Vec3 place = {}, up = {}; ///< [m], [-]
    double stiffness = 0.0;   ///< [N/m], their grips'
    double speed = 0.0;       ///< [m/s] their largest
    double dt = 0.0;          ///< [s]

    /// Moves a hand along its strand, away from an origin, so that it draws with this force [N]; returns by how much.
    double draw(StrandHand& hand, Vec3 origin, double force) const;
    /// Turns it towards a direction from the place, and draws; returns whether it is there and rests.
    [[nodiscard]] bool turn(StrandHand& hand, Vec3 to, double force) const;
    /// Moves it in a straight line; returns whether it is there.
    bool goTo(StrandHand& hand, Vec3 to) const;
    /// Brings it here at once, with nothing in it.
    void put(StrandHand& hand, Vec3 at) const;
};

} // namespace filasofia::prefab
