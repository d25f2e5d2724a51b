#pragma once

#include "session.h"
#include "where.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <vector>

namespace filasofia::python {

/// A callback of the user's, for an event or (alternative == kEveryStep) for every step.
struct Observer {
    static constexpr std::size_t kEveryStep = std::variant_size_v<Arrived>;
    std::uint64_t id = 0;
    std::size_t alternative = 0;
    nb::object call;
};

/// A simulation as Python holds it: the session, and the callbacks, which the garbage collector must see.
struct HeldSimulation {
    std::shared_ptr<Session> session;
    std::vector<Observer> observers = {};
    std::atomic<bool> scripted = false; ///< whether one of them is for every step; read without the interpreter's lock
    std::uint64_t lastObserver = 0;
    double owed = 0.0;  ///< [-] the part of a step, in [-0.5, 0.5], that the calls of run() until now lack
    bool shown = false; ///< the user chose what is drawn
    /// Else all bodies are. The interpreter's lock guards it, like all members.
    std::map<BodyId, runtime::ShownId> shownByUs = {};
    std::map<BodyId, runtime::ShownId> shownByScene = {}; ///< ours from the first picture on
    std::set<BodyId> shownBeside = {};                    ///< by a library, which leaves it at showing all
    ~HeldSimulation();
};

/// A kinematic element that moves while steps are made: straight from pose to pose at constant speed.
struct Move {
    BodyId body = {};
    int element = 0;
    Pose from = {}, to = {};
};

/// Makes `count` steps without the interpreter's lock, and delivers each step's events before the next step. If a
/// callback raises, the step in progress is finished, and its exception is raised here; those of further callbacks of
/// the same step are printed. The caller has the session's turn.
physics::StepReport makeSteps(HeldSimulation& held, std::uint64_t count, const char* what,
                              const std::vector<Move>& moves = {});

} // namespace filasofia::python
