#pragma once

#include "filasofia/math/pose.h"
#include "filasofia/physics/defs.h"
#include "filasofia/testing/fuzz_random.h"

#include <vector>

namespace filasofia::testing {

/// The kinds of scenes of threads.
enum class KnotKind { Threads, Rings, Overhand, Surgeon, Bars, Tissue, count_ };
const char* name(KnotKind kind);

/// A kinematic body that moves from one random place near its home to the next.
struct FuzzHand {
    std::size_t body = 0; ///< index in KnotScene::bodies
    Vec3 home = {};       ///< [m]
    double reach = 0.0;   ///< [m]
    bool turns = false;   ///< turns as well

    Pose now = {};
    Vec3 target = {};
    Vec3 axis{0, 0, 1};
    double speed = 0.0; ///< [m/s]; 0: it pauses
    double until = 0.0; ///< [s] when it chooses again at the latest
    void move(double time, double dt, FuzzRandom& random);
};

/// A line that threads must not pass through: a thread's own, or the axis of a bar.
struct FuzzLine {
    std::size_t body = 0;        ///< index in KnotScene::bodies
    bool closed = false;         ///< a ring
    std::vector<Vec3> axis = {}; ///< [m] in a rigid body's coordinates; empty: a rod
};

/// A scene for a FuzzStage.
struct KnotScene {
    std::vector<physics::BodyDef> bodies;
    std::vector<FuzzHand> hands;
    std::vector<FuzzLine> lines;
    std::vector<std::size_t> tissues; ///< indices in `bodies`
    double radius = 0.0;              ///< [m] radius that all threads have
};
KnotScene knotScene(KnotKind kind, FuzzRandom& random);

} // namespace filasofia::testing
