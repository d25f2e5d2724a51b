#pragma once

#include "filasofia/math/pose.h"
#include "filasofia/physics/defs.h"
#include "filasofia/testing/fuzz_random.h"

#include <vector>

namespace filasofia::testing {

/// The kinds of scenes of bodies that touch; from Blade on those of tools.
enum class ContactKind { Drop, Heap, Press, Jaws, Drape, Plates, Blade, ThreadsFall, ThreadsDrawn, Needle, count_ };
inline constexpr ContactKind kFirstToolKind = ContactKind::Blade;
const char* name(ContactKind kind);

/// A kinematic body that goes in straight lines from pose to pose, and stays at the last one.
struct ToldBody {
    struct Key {
        double time = 0.0; ///< [s]
        Pose pose = {};
    };
    std::size_t body = 0; ///< index in ContactScene::bodies
    std::vector<Key> keys = {};
    [[nodiscard]] Pose at(double time) const;
};

/// A scene for a FuzzStage. Body 0 is the floor, whose top is at y = 0.
struct ContactScene {
    std::vector<physics::BodyDef> bodies;
    std::vector<ToldBody> told;
    double period = 1e-3; ///< [s] duration of a step
    bool tools = false;   ///< a scene of blades, threads and needles
    double acts = 0.0;    ///< [s] after which nothing drives the bodies but gravity
};
ContactScene contactScene(ContactKind kind, FuzzRandom& random);

} // namespace filasofia::testing
