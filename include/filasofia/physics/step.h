#pragma once

#include "filasofia/core/attachment_id.h"
#include "filasofia/core/body_id.h"
#include "filasofia/math/vec3.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

namespace filasofia::physics {

/// Problems of a step. Never an exception: the simulation continues and stays finite.
enum class StepFlag : std::uint32_t {
    Late = 1u << 0,    ///< it began more than a period late (runtime)
    Clamped = 1u << 1, ///< dt was cut to period + slack: simulated time fell behind (runtime)
    /// a solver stopped at its iteration limit, and the body lost speed in proportion to the error; or contact forces
    /// are off from their law (ContactReport::mismatch) by more than 5 %; or what is attached hard misses what it is to
    /// do by more than 0.2 mm in a step, as a pair that stays 2 mm apart
    NotConverged = 1u << 2,
    Undone =
        1u
        << 3, ///< a body's new state was not finite: it was restored to the state before the step, with zero velocity
    EventLost = 1u << 4,    ///< the event queue was full (runtime)
    RecordLost = 1u << 5,   ///< the step log was full; in a record: steps before it are missing
    Tuned = 1u << 6,        ///< tune() ran: a recording cannot be replayed beyond this step
    TuneRejected = 1u << 7, ///< tune() threw or left an invalid model: everything was rolled back
    Damped = 1u << 8,       ///< a restored body repeated its step from rest, heavily damped, and the result was finite
    OutOfTime = 1u << 9,    ///< a solver stopped at the deadline, short of its tolerance: the body lost some speed
    NothingAttached = 1u << 10, ///< an attachment found no node, or a grasp no contact: the log says which
    Inverted = 1u << 11,        ///< elements were inside out at the start of the step (StepReport::inverted)
    BeyondStrain = 1u << 12,   ///< elements were strained beyond the range of their material (StepReport::beyondStrain)
    NothingChanged = 1u << 13, ///< a SetTissue found no element: the log says which
    Restless = 1u << 14,       ///< a body goes on moving though nothing drives it (StepReport::unrest)
    EnergyGained = 1u << 15,   ///< a restless body moves with ever more energy than it has gained by falling
    Intersecting = 1u << 16,   ///< surfaces of bodies pass through each other (StepReport::intersections)
};

/// How one body's step was solved. Bodies that are in contact or attached to each other are solved together: they have
/// the same numbers, and end at the same tolerance (their smallest) and at the same deadline. Every solve, also that of
/// rigid bodies among themselves, may take a share of the step's time in proportion to its size, so that the first
/// solve leaves time for the last.
struct BodySolve {
    BodyId body;           ///< for rigid bodies that were solved among themselves: the first of them
    int iterations = 0;    ///< [-], 0 for explicitly integrated bodies without contacts
    double residual = 0.0; ///< [-], the error that the solver's tolerance bounds
    BodyId together = {};  ///< the first of the bodies that were solved together; this one if it was solved alone
};

/// The durations of a step's stages [s]. Zeros if the step had no clock.
struct StageTimes {
    double commands = 0.0; ///< applying commands
    double contacts = 0.0; ///< finding contacts
    double assemble = 0.0; ///< rotations, forces, stiffness
    double advance = 0.0;  ///< the solve, and moving the nodes
    double topology = 0.0; ///< cuts and tears, and the updates that follow
};

/// The tetrahedra that were inside out (det F <= 0) at the start of a step, in all bodies.
struct InvertedElements {
    int count = 0;       ///< [-]
    BodyId body = {};    ///< the body of the worst of them
    int element = -1;    ///< [-] the worst: a tetrahedron of that body's mesh, or a part of it that cuts have made
    double volume = 1.0; ///< [-] det F of the worst: its volume over that at rest
    Vec3 place = {};     ///< [m] its centre
};

/// The elements that were strained beyond the range of their material at the start of a step: beyond validStrain of
/// FemMaterial or ShellMaterial, or beyond the limit of an elastic law (rangeOf).
struct StrainedElements {
    int count = 0;    ///< [-]
    BodyId body = {}; ///< the body of the worst of them
    int element = -1; ///< [-] the worst: a tetrahedron or a triangle of that body's mesh, or a part that cuts have made
    /// [-] the largest difference of a principal stretch from 1, or the difference of the mean stretch at
    /// constant volume, sqrt(i1 / 3), from 1 if the law's limit is exceeded by more.
    double strain = 0.0;
    double valid = 0.0; ///< [-] its material's validStrain, or sqrt((3 + rangeOf(law)) / 3) - 1
    Vec3 place = {};    ///< [m] its centre
};

/// Bodies that go on moving though nothing drives them: no command, tool, hand, force or pressure has changed for at
/// least 5 s, and in the last four seconds the fastest point of the body moved faster than 1 mm/s (root mean square
/// over each second), hardly slower in the last one than before. Also a body that spins or flies without damping.
struct Unrest {
    int bodies = 0;        ///< [-] number of restless bodies
    BodyId body = {};      ///< the one with the fastest point
    double speed = 0.0;    ///< [m/s] the speed of that point, root mean square over a second
    double undriven = 0.0; ///< [s] since something drove the scene
};

/// Why two surfaces pass through each other.
enum class IntersectionCause {
    Start, ///< they did when one of the two bodies was added
    Told,  ///< one of the two is told where to be, and had moved in the second before: nothing stops it
    Own,   ///< the body does not collide with itself
    Lost,  ///< contacts could not hold them apart: too much force, or too fast
};

/// Two bodies whose surfaces pass through each other, or a body whose surface passes through itself.
struct Intersection {
    BodyId first = {}, second = {}; ///< first <= second; equal: the body's own surface
    int crossings = 0;  ///< [-] number of edges that pass through a triangle; 0: one body lies wholly inside the other
    double depth = 0.0; ///< [m] > 0, how deep the deepest of these edges is inside, or reaches beyond a sheet
    Vec3 place = {};    ///< [m] where that edge passes through
    IntersectionCause cause = IntersectionCause::Lost; ///< when they were first told, and until they part
    double force = 0.0; ///< [N] the sum of the normal forces between the two in this step, where contacts hold
};

/// Statistics of the contacts of a step.
struct ContactReport {
    int found = 0;  ///< number of contacts found
    int active = 0; ///< number of contacts with a force
    int rounds = 0; ///< 1; more after multiplier updates; the maximum over the groups of bodies in contact
    double mismatch =
        0.0; ///< [-] largest violation of the contact law by the forces, relative to the largest force; 0 if it holds
    double penetration = 0.0; ///< [m], >= 0, the deepest penetration at the start of the step
};

/// A part of a body that was detached.
struct LoosePiece {
    int piece = 0; ///< its number from now on: 1, 2, ... within the body; the part that it came from keeps its number
    std::vector<int> elements = {}; ///< tetrahedra, triangles of a shell, edges of a rod; ascending
    double mass = 0.0;              ///< [kg]
    Vec3 place = {};                ///< [m] its current centre of mass
    bool held = false;              ///< some of its nodes are attached to the world or to a kinematic body
};

/// What blades or stress opened in a body during a step.
struct Rupture {
    enum class Kind { Cut, Tear };
    Kind kind = Kind::Cut;
    BodyId body = {};
    Vec3 place = {}; ///< [m] current centre of the opened surface
    /// [m^2] opened area at rest, of one of the two sides: in a shell length times thickness, in a rod its
    /// cross-section per cut
    double area = 0.0;
    int nodes = 0;                         ///< [-] number of nodes added
    int elements = 0;                      ///< [-] number of elements added
    std::vector<LoosePiece> detached = {}; ///< pieces that were detached
    std::vector<int> cavities = {};        ///< cavities of the body that were opened, as their indices
};

/// A piece that went farther than 10 m and was removed.
struct LostPiece {
    BodyId body = {};
    int piece = 0;      ///< its number: LoosePiece::piece
    double mass = 0.0;  ///< [kg]
    double share = 0.0; ///< [-], in (0, 1], of the mass that the body had as a whole
};

/// Statistics of the mesh edits of a step: all bodies, cuts and tears. Edits are atomic: a refused edit leaves its body
/// unchanged.
struct TopologyReport {
    std::vector<Rupture> ruptures = {}; ///< cuts before tears, each in ascending order of bodies
    int bladeNotFinite = 0;             ///< refused: a blade's position is not finite
    int bladeNoLength = 0;              ///< refused: a blade has no length
    int bladeJump = 0;                  ///< refused: a blade moved further in one step than the body is long
    int bladeTooFast = 0; ///< refused: a blade jumped across a body, faster than 20 m/s or by more than 1 rad
    int bladeOff = 0;     ///< refused: a blade that was switched off in tissue was pushed further into it
    int edgeGone = 0;     ///< refused: an edge to be cut had been cut meanwhile
    int tearClosed = 0;   ///< refused: a tear would have opened nothing, or left an invalid surface
    int noPiece = 0;      ///< refused: a piece to be removed does not exist, or is all that is left of the body
    int inVain = 0;       ///< strokes that ended, had crossed edges and opened nothing
    int lost = 0;         ///< pieces that went farther than 10 m and were removed
    int putOff = 0;       ///< faces that could not be opened yet and are tried again
    int pending = 0;      ///< crossings and tears that wait for the next step
    std::vector<LostPiece> lostPieces = {}; ///< what `lost` counts, in ascending order of bodies
    /// Rigid bodies of which no blade cuts, as no body that may be cut has their collision groups, though there are
    /// such bodies. In the order in which they were added; empty with the SOFA engine.
    std::vector<BodyId> idleBlades = {};
    [[nodiscard]] int refused() const { return bladesRefused() + edgeGone + tearClosed + noPiece; }
    [[nodiscard]] int bladesRefused() const
    {
        return bladeNotFinite + bladeNoLength + bladeJump + bladeTooFast + bladeOff;
    }
};

/// What became of clips in a step.
struct ClipReport {
    int applied = 0; ///< [-] clips that began to close on tissue
    int missed = 0;  ///< [-] clips that had nothing between their legs
    int slipped = 0; ///< [-] clips that were pulled off, or whose tissue was removed
    int partial = 0; ///< [-] clips among those applied that are too small: tissue goes on beyond their legs
};

/// What became of one clip in a step.
struct ClipChange {
    enum class Kind { Applied, Missed, Slipped };
    Kind kind = Kind::Applied;
    AttachmentId id = {};
    BodyId clip = {};     ///< the rigid body
    BodyId tissue = {};   ///< the soft body
    bool partial = false; ///< tissue went on beyond its legs when it was applied: it does not close all of it
};

/// An attachment or a grasp that was asked for and holds nothing: no node, or no contact, is where it should hold.
struct NothingHeld {
    AttachmentId id = {};
    BodyId body = {};   ///< the attached body; of a grasp, the one that grasps
    BodyId to = {};     ///< to what it is attached, none for space; of a grasp, what is grasped
    bool grasp = false; ///< a grasp, and no attachment
};

/// An attachment or a grasp of which points let go in a step: they bore more than they can, or a blade parted them.
struct AttachmentBreak {
    AttachmentId id = {};
    BodyId body = {};    ///< the attached body; of a grasp, what is grasped
    BodyId to = {};      ///< to what it was attached, none for space; of a grasp, the body that grasps
    bool grasp = false;  ///< a grasp, and no attachment
    double force = 0.0;  ///< [N] that it carried in this step, summed over its points
    int points = 0;      ///< [-] number of points that let go: all that were left, if it is broken
    bool broken = false; ///< nothing of it holds any more
};

/// The time budget of a step. It affects only where the solvers stop.
struct StepBudget {
    std::function<std::int64_t()> now =
        {}; ///< [ns], a steady clock that any thread may read; empty: neither deadline nor durations
    std::int64_t deadline = std::numeric_limits<std::int64_t>::max(); ///< [ns], on that clock
    /// Replaces the deadline in a replay: the iterations that each solver made in the recorded step, in the order of
    /// StepReport::solves; empty: solvers end by themselves. Like a deadline, it applies to the default solver, and to
    /// bodies in contact or attached to each other.
    std::vector<int> iterations = {};
};

/// The report of a step.
struct StepReport {
    std::uint64_t step = 0;          ///< number of steps completed, including this one
    double time = 0.0;               ///< [s], simulated, at the end of the step
    double dt = 0.0;                 ///< [s]; 0 while paused
    std::uint32_t flags = 0;         ///< StepFlag bits
    std::vector<BodyId> undone = {}; ///< bodies that were restored to the state before the step (Undone), ascending
    /// Per soft body, in the order of their ids; then per group of rigid bodies solved among themselves.
    std::vector<BodySolve> solves = {};
    ContactReport contacts = {};
    /// Pairs of bodies that may collide and whose surfaces pass through each other, ascending. This does not ask the
    /// contacts, but tests edges against triangles, every 10 ms of simulated time, and more often if what may meet
    /// moves fast. A soft body that does not collide with itself is tested against itself every second, or every
    /// 100 ms once it has been cut: then both bodies are the same. In between the last answer stays.
    std::vector<Intersection> intersections = {};
    InvertedElements inverted = {};
    StrainedElements beyondStrain = {};
    Unrest unrest = {};
    TopologyReport topology = {};
    ClipReport clips = {};
    std::vector<ClipChange> clipChanges = {}; ///< what `clips` counts, in the order in which it happened
    /// Attachments and grasps that began in this step and hold nothing (NothingAttached), ascending in each group.
    std::vector<NothingHeld> nothingHeld = {};
    std::vector<AttachmentBreak> breaks = {}; ///< attachments and grasps of which points let go, ascending
    StageTimes times = {};

    void set(StepFlag flag) { flags |= static_cast<std::uint32_t>(flag); }
    [[nodiscard]] bool has(StepFlag flag) const { return (flags & static_cast<std::uint32_t>(flag)) != 0; }
    /// Notes that a body was restored, once.
    void setUndone(BodyId body)
    {
        set(StepFlag::Undone);
        const auto at = std::ranges::lower_bound(undone, body);
        if (at == undone.end() || *at != body) undone.insert(at, body);
    }
    /// [-] of all solves, each counted once, however many bodies were solved together
    [[nodiscard]] int iterations() const
    {
        int sum = 0;
        for (const BodySolve& solve : solves) sum += solve.together == solve.body ? solve.iterations : 0;
        return sum;
    }
};

} // namespace filasofia::physics
