#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/math/vec3.h"

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
    double topology = 0.0; ///< cuts and tears, and all that follows them
};

/// How the contacts of a step went.
struct ContactReport {
    int found = 0;            ///< places where surfaces were near each other
    int active = 0;           ///< of these, that pushed
    int rounds = 0;           ///< 1, more where forces were raised, at most [of the groups of bodies that touch]
    double mismatch = 0.0;    ///< [-] forces short of the law, relative to the largest; 0 where it was followed
    double penetration = 0.0; ///< [m], >= 0, the deepest at the start of the step
};

/// A part of a body that came loose.
struct LoosePiece {
    int piece = 0; ///< its number from now on: 1, 2, ... within the body; what it came from keeps its own
    std::vector<int> elements = {}; ///< tetrahedra, ascending
    double mass = 0.0;              ///< [kg]
    Vec3 place = {};                ///< [m] its centre of mass, as it is now
    bool held = false;              ///< nodes of it are fixed to the world or to a body that goes where it is told
};

/// What blades or stress opened of a body during a step.
struct Rupture {
    enum class Kind { Cut, Tear };
    Kind kind = Kind::Cut;
    BodyId body = {};
    Vec3 place = {};                       ///< [m] the middle of what was opened, as it is now
    double area = 0.0;                     ///< [m^2] opened, at rest, of one of the two sides
    int nodes = 0;                         ///< [-] that came
    int elements = 0;                      ///< [-] that came
    std::vector<LoosePiece> detached = {}; ///< what came loose by it
};

/// How edits of meshes went in a step: all bodies, cuts and tears. Nothing is ever half done: what is refused leaves
/// its body as it was.
struct TopologyReport {
    std::vector<Rupture> ruptures = {}; ///< cuts before tears, each by rising body
    int bladeNotFinite = 0;             ///< refused: a blade's place is no number
    int bladeNoLength = 0;              ///< refused: a blade without any length
    int bladeJump = 0;                  ///< refused: in one step further than the body is long
    int bladeTooFast = 0;               ///< refused: a jump across a body, faster than 20 m/s or by more than 1 rad
    int edgeGone = 0;                   ///< refused: what was to be cut had been cut meanwhile
    int tearClosed = 0;                 ///< refused: a tear that would have opened nothing, or left no proper surface
    int noPiece = 0;                    ///< refused: a piece to be removed that there is not, or that is all there is
    int lost = 0;                       ///< pieces that went farther than 10 m and were taken out of the scene
    int putOff = 0;                     ///< faces that could not be opened yet and are tried again
    int pending = 0;                    ///< crossings and tears that wait for the next step
    [[nodiscard]] int refused() const
    {
        return bladeNotFinite + bladeNoLength + bladeJump + bladeTooFast + edgeGone + tearClosed + noPiece;
    }
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
    TopologyReport topology = {};
    StageTimes times = {};

    void set(StepFlag flag) { flags |= static_cast<std::uint32_t>(flag); }
    [[nodiscard]] bool has(StepFlag flag) const { return (flags & static_cast<std::uint32_t>(flag)) != 0; }
};

} // namespace filasofia::physics
