#pragma once

#include "apps/filasofia/bench/contact_run.h"

/// Threads alone, on a floor, and in tissue.
namespace filasofia::app {

/// A scene whose rod has `nodes` nodes. It settles, and is then measured for `counted` [s].
struct RodScene {
    ContactScene scene = {};
    int nodes = 0;
    double counted = 1.0;
};

RodScene hangingRod(int nodes);
RodScene rodOnFloor(int nodes); ///< a spiral
RodScene coiledRod(int nodes);  ///< it goes around three times, each time above itself

/// An overhand knot of eight turns between two hands that draw it tight: it pushes at itself in about 50 places.
RodScene knottedRod(int nodes);

/// A curved needle goes through both edges of a wound, of 5,040 tetrahedra, and draws a thread of 150 nodes after it.
RodScene stitch();

/// A needle draws a thread of 150 nodes through so many of 16 blocks at 0.1 m/s; measured while the thread slides in
/// all of these.
RodScene drawnThrough(int blocks);

} // namespace filasofia::app
