#pragma once

#include "filasofia/core/body_id.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

namespace filasofia::physics {

/// What a step could not do as asked. Never an exception: the simulation goes on and stays finite.
enum class StepFlag : std::uint32_t {
    Late = 1u << 0,         ///< woke up more than a period late (runtime)
    Clamped = 1u << 1,      ///< dt was cut to period + slack: simulated time fell behind (runtime)
    NotConverged = 1u << 2, ///< a solver stopped at its cap: the body gave up as much of its speed as the error was
    Undone = 1u << 3,       ///< a body's new state was not finite: it went back to where it was, and lost its velocity
    EventLost = 1u << 4,    ///< the event queue was full (runtime)
    RecordLost = 1u << 5,   ///< the step log was full; in a record: steps before it are missing
    Tuned = 1u << 6,        ///< tune() ran: a recording cannot be replayed from here on
    TuneRejected = 1u << 7, ///< tune() threw or left an invalid model: everything was put back
    Damped = 1u << 8,       ///< an undone body made its step again from rest, heavily damped, and it came out finite
    OutOfTime = 1u << 9,    ///< a solver stopped at the deadline, short of its tolerance: the body gave up some speed
    NothingAttached = 1u << 10, ///< an attachment found no node, or a grasp no contact: the log says which
};

/// How one body's step was solved. Bodies that touch or hold each other are solved as one: they have the same numbers,
/// end at the same tolerance (the smallest of theirs) and at the same deadline. Of the step's time every solve may take
/// its share, by its size, rigid bodies among themselves too: whoever comes first leaves time for who comes last.
struct BodySolve {
    BodyId body;           ///< of rigid bodies that were solved among themselves: the first of them
    int iterations = 0;    ///< [-], 0 for explicit bodies that touch nothing
    double residual = 0.0; ///< [-], the error that the solver's tolerance is about
};

/// What the stages of a step took [s]. Zeros where the step was given no clock.
struct StageTimes {
    double commands = 0.0; ///< applying them
    double contacts = 0.0; ///< finding who touches whom
    double assemble = 0.0; ///< rotations, forces, stiffness
    double advance = 0.0;  ///< the solve, and moving the nodes
};

/// How the contacts of a step went.
struct ContactReport {
    int found = 0;            ///< places where surfaces were near each other
    int active = 0;           ///< of these, that pushed
    int rounds = 0;           ///< of finding out which, at most [of the groups of bodies that touch]
    double mismatch = 0.0;    ///< [-] forces short of the law, relative to the largest
    double penetration = 0.0; ///< [m], >= 0, the deepest at the start of the step
};

/// How long a step may take. Of all that a step computes it changes only where its solvers stop.
struct StepBudget {
    std::function<std::int64_t()> now = {}; ///< [ns], a steady clock for any thread; empty: neither deadline nor times
    std::int64_t deadline = std::numeric_limits<std::int64_t>::max(); ///< [ns], on that clock
    /// In place of a deadline, when a step is made again: the iterations that each solver made then, in the order of
    /// StepReport::solves; empty: solvers end by themselves. As a deadline it is for the default solver, and for bodies
    /// that touch or hold each other.
    std::vector<int> iterations = {};
};

/// How a step went.
struct StepReport {
    std::uint64_t step = 0;  ///< number of steps made, this one included
    double time = 0.0;       ///< [s], simulated, at the end of the step
    double dt = 0.0;         ///< [s]; 0 while paused
    std::uint32_t flags = 0; ///< StepFlag bits
    /// Per soft body, in the order of their ids; then per group of rigid bodies solved among themselves.
    std::vector<BodySolve> solves = {};
    ContactReport contacts = {};
    StageTimes times = {};

    void set(StepFlag flag) { flags |= static_cast<std::uint32_t>(flag); }
    [[nodiscard]] bool has(StepFlag flag) const { return (flags & static_cast<std::uint32_t>(flag)) != 0; }
};

} // namespace filasofia::physics
