#pragma once

#include "filasofia/physics/physics_server.h"
#include "filasofia/testing/fuzz_contact_scene.h"
#include "filasofia/testing/fuzz_laws.h"

#include <functional>
#include <limits>
#include <vector>

namespace filasofia::testing {

/// The kinds of scenes: one per elastic law, in the order of the variant, and shells.
inline constexpr std::size_t kLawKinds = std::variant_size_v<physics::ElasticLaw> + 1;
std::string nameOfLawKind(std::size_t kind);

inline constexpr std::size_t kTissue = 1; ///< index of the body that tools act on

/// Something that happens at a time, before the step that begins there.
struct LawEvent {
    double time = 0.0; ///< [s]
    std::function<void(physics::PhysicsServer& server, const std::vector<BodyId>& bodies)> happen = {};
    bool changesRest = false; ///< what was strained before it need not be so in the step that it begins
};

/// A scene of small soft bodies and of tools that act on them.
struct LawScene {
    std::vector<physics::BodyDef> bodies = {}; ///< the first is the floor, whose top is at y = 0
    std::vector<ToldBody> told = {};           ///< the tools
    std::vector<LawEvent> events = {};
    double period = 1e-3;   ///< [s] duration of a step
    int acting = 0;         ///< [-] steps after which all tools are removed
    int calm = 0;           ///< [-] steps that follow
    bool contracts = false; ///< muscle in tissue that flows: it shortens on and on, which is work
    bool relaxes = false;   ///< tissue holds energy that mechanicalEnergy() does not know
    double validStrain = std::numeric_limits<double>::infinity(); ///< [-] the same in all bodies
};

/// A random scene; counts in the report what it contains.
LawScene lawScene(std::size_t kind, FuzzRandom& random, LawFuzzKind& counts, LawFuzzReport& report);

} // namespace filasofia::testing
