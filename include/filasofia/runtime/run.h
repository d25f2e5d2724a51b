#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/physics/step.h"
#include "filasofia/runtime/timing.h"
#include "filasofia/surface/distension_def.h"
#include "filasofia/surface/duct_def.h"
#include "filasofia/surface/electrode_def.h"
#include "filasofia/surface/smoke_def.h"
#include "filasofia/surface/treatment.h"
#include "filasofia/visual/visual_server.h"

#include <array>
#include <string>

namespace filasofia::runtime {

/// How a simulation is run.
struct RunDef {
    /// A plain loop of steps of one period each, without threads or clock; every run gives the same result.
    bool headless = false;
    visual::Backend backend = visual::Backend::Window; ///< where a live run draws
    int steps = 0;                                     ///< [-], >= 0, the run ends after as many steps; 0: no limit
    double seconds = 0.0;     ///< [s], in [0, 1e8], wall time after which a live run ends; 0: no limit
    std::string picture = {}; ///< a PNG file for the last state; empty: none
    /// [s], 0 or >= 1e-3, headless only: interval of numbered pictures, simulated.
    double pictureEvery = 0.0;
    std::string log = {};     ///< a CSV file with a line per step; empty: none
    std::string record = {};  ///< a .rec file for `filasofia replay`, only in a simulation's first run; empty: none
    bool freeRunning = false; ///< a live run does not wait between steps, to measure what they cost
    std::string video = {};   ///< an .mp4 (encoded by the program ffmpeg) or .avi file; empty: none
    /// Devices of the first haptic interfaces, in place of their own: NAME or NAME:LIBRARY, more than one separated by
    /// commas; empty: their own. Several forcedimension are its devices 0, 1, ...
    std::string device = {};
    std::string motion = {};       ///< motion files that are played in place of those devices; empty: none
    std::string recordMotion = {}; ///< a motion file that records the hand at the first haptic interface; empty: none
    /// [1/s], in [1, 240], pictures per second of the video; headless in simulated time, else wall time.
    double fps = 30.0;
    int seed = 0;             ///< [-], >= 0, seed of your program's random numbers; only stored in the recording
    std::string session = {}; ///< name of the session, any text; only stored in the recording
    std::string trainee = {}; ///< name of the trainee, any text; only stored in the recording
};
constexpr auto fields(const RunDef*)
{
    using T = RunDef;
    return describe(
        "RunDef", field("headless", &T::headless, "a plain loop with fixed steps"),
        field("backend", &T::backend, "where a live run draws"),
        field("steps", &T::steps, "-", nonNegative(), "the run ends after as many steps"),
        field("seconds", &T::seconds, "s", closed(0, 1e8), "the run ends after this wall time"),
        field("picture", &T::picture, "a PNG file for the last state"),
        field("pictureEvery", &T::pictureEvery, "s", nonNegative(), "interval of numbered pictures"),
        field("log", &T::log, "a CSV file with a line per step"),
        field("record", &T::record, "a file from which the run can be replayed"),
        field("freeRunning", &T::freeRunning, "do not wait between steps"),
        field("video", &T::video, "an MP4 or AVI file"),
        field("device", &T::device, "device of the first haptic interface"),
        field("motion", &T::motion, "a motion file played in place of a device"),
        field("recordMotion", &T::recordMotion, "a motion file that records the hand"),
        field("fps", &T::fps, "1/s", closed(1, 240), "pictures per second of the video"),
        field("seed", &T::seed, "-", nonNegative(), "seed of the program's random numbers, stored in the recording"),
        field("session", &T::session, "name of the session, stored in the recording"),
        field("trainee", &T::trainee, "name of the trainee, stored in the recording"));
}

/// How two bodies touched in a run. Forces of steps in which a solver stopped short of its tolerance
/// (StepFlag::NotConverged, OutOfTime) are unfinished: they are not in the means and maxima.
struct ContactPairReport {
    std::string first, second;      ///< their names
    std::uint64_t steps = 0;        ///< [-], number of steps in which they touched
    double meanNormalForce = 0.0;   ///< [N], mean of the sum over their contacts; 0 if no step was solved
    double maxNormalForce = 0.0;    ///< [N], maximum over the steps
    double meanFrictionForce = 0.0; ///< [N], mean of the sum of magnitudes over their contacts
    double maxFrictionForce = 0.0;  ///< [N], maximum over the steps
    double deepest = 0.0;           ///< [m], >= 0, deepest penetration at the start of a step
    std::uint64_t unsolved = 0;     ///< [-], steps among these in which a solver stopped short of its tolerance
    double maxUnsolvedForce = 0.0;  ///< [N], maximum of the normal force over those
};

/// What was opened of a body in a run.
struct OpenedSurfaces {
    std::string body = {};      ///< its name
    std::uint64_t steps = 0;    ///< [-], steps that opened something of it
    double cut = 0.0;           ///< [m^2], area that blades opened, at rest, of one of the two sides
    double torn = 0.0;          ///< [m^2], the same for tears
    std::uint64_t pieces = 0;   ///< [-], pieces that came off
    std::uint64_t cavities = 0; ///< [-], cavities that were opened
};

/// What a body has lost in a run: pieces that went farther than 10 m and were removed.
struct LostPiecesReport {
    std::string body = {};    ///< its name
    std::uint64_t pieces = 0; ///< [-]
    double mass = 0.0;        ///< [kg]
    double share = 0.0;       ///< [-], in (0, 1], of the mass that the body had as a whole
};

/// What was asked of blades in a run and not done (physics::TopologyReport).
struct RefusedBlades {
    std::uint64_t steps = 0;  ///< [-], steps with a blade that was not used
    std::uint64_t jumped = 0; ///< [-], steps among these in which one jumped, and cut nothing on its way
    /// [-], steps among these in which one that is off was pushed on into the tissue that it is in
    std::uint64_t off = 0;
    std::uint64_t inVain = 0;  ///< [-], strokes that had crossed edges and opened nothing when they ended
    std::uint64_t noPiece = 0; ///< [-], pieces that could not be removed (TopologyReport::noPiece)
};

/// What became of the blood of a body that bleeds.
struct BloodReport {
    std::string body = {}; ///< its name
    surface::BloodBalance balance = {};
};

/// What became of the heat of a body that burns.
struct HeatReport {
    std::string body = {}; ///< its name
    bool target = true;    ///< BurningDef::target
    surface::HeatBalance balance = {};
};

/// What an electrode has done.
struct EnergyReport {
    std::string body = {}; ///< its name
    int electrode = 0;     ///< [-], index among those of the body
    surface::EnergyMode mode = surface::EnergyMode::Cut;
    surface::EnergyBalance balance = {};
};

/// What has become of a duct.
struct DuctReport {
    std::string body = {}; ///< its name
    std::string duct = {}; ///< DuctDef::name
    surface::DuctBalance balance = {};
};

/// How a run went.
struct RunReport {
    RunTiming timing;
    visual::VisualStatistics visual; ///< zeros if nothing was drawn
    double time = 0.0;               ///< [s], simulated since the simulation began
    std::uint64_t steps = 0;         ///< [-], made since the simulation began
    std::uint64_t hash = 0;          ///< hash of the last state
    std::uint64_t undone = 0;        ///< [-], steps in which a body was rolled back (StepFlag::Undone)
    std::string undoneBody = {};     ///< the name of the first that was; empty in a scene of SOFA, which does not say
    /// [-], steps among these in which it was advanced again from rest, damped (StepFlag::Damped)
    std::uint64_t damped = 0;
    /// [-], steps without a break at the end of the run in which a body was rolled back: physics has failed
    std::uint64_t undoneAtEnd = 0;
    std::uint64_t notConverged = 0; ///< [-], steps with StepFlag::NotConverged
    std::uint64_t outOfTime = 0;    ///< [-], steps in which a solver stopped at the deadline (StepFlag::OutOfTime)
    std::uint64_t intersecting = 0; ///< [-], steps in which surfaces pass through each other (StepFlag::Intersecting)
    physics::Intersection deepestIntersection = {}; ///< in the step in which it was deepest
    std::array<std::string, 2> deepestBodies = {};  ///< the names of its bodies
    std::uint64_t inverted = 0; ///< [-], steps that began with elements inside out (StepFlag::Inverted)
    physics::InvertedElements worstInverted = {}; ///< in the step with the most of them
    std::string worstInvertedBody = {};           ///< the name of its body
    /// [-], steps that began with elements beyond the range of their material (StepFlag::BeyondStrain)
    std::uint64_t beyondStrain = 0;
    physics::StrainedElements worstStrained = {}; ///< in the step with the largest strain in relation to its range
    std::string worstStrainedBody = {};           ///< the name of its body
    std::uint64_t restless = 0;       ///< [-], steps in which a body moved though nothing drove it (StepFlag::Restless)
    std::uint64_t energyGained = 0;   ///< [-], steps among these in which it gained energy (StepFlag::EnergyGained)
    physics::Unrest worstUnrest = {}; ///< in the step with the fastest such body
    std::string worstUnrestBody = {}; ///< the name of that body
    std::vector<OpenedSurfaces> opened;              ///< one per body that was cut or torn, ascending by their ids
    RefusedBlades refused = {};                      ///< what blades were not used for, or did in vain
    bool realTime = false;                           ///< physics was scheduled before ordinary threads
    std::string finished;                            ///< why it ended
    std::vector<ContactPairReport> contacts;         ///< one per pair of bodies that touched, ascending by their ids
    std::vector<BloodReport> blood;                  ///< one per body that bleeds, ascending by their ids
    std::vector<LostPiecesReport> lost;              ///< one per body that lost pieces, ascending by their ids
    std::vector<HeatReport> heat;                    ///< one per body that burns, ascending by their ids
    std::vector<EnergyReport> energy;                ///< one per electrode, in the order in which they were added
    std::vector<DuctReport> ducts;                   ///< one per duct, in the order in which they were added
    std::optional<surface::SmokeBalance> smoke = {}; ///< if there is a room for it
    std::optional<surface::DistensionBalance> distension = {}; ///< if a fluid distends a cavity
    physics::ClipReport clips = {};                            ///< in all steps
    std::uint64_t nothingChanged = 0; ///< [-], steps with a SetTissue that found no element (StepFlag::NothingChanged)
    std::vector<std::string> nothingHeld; ///< one line per attachment or grasp that held nothing; after 12 a count
    /// One line per attachment or grasp of which points let go, with the time; after 12 a count
    std::vector<std::string> broke;
    /// One line per blade that touched a soft body without dynamicTopology, and per body of which no blade cuts at the
    /// end of the run, as no body that may be cut has their groups.
    std::vector<std::string> bluntBlades;
    /// why functions of everyStep() are no longer called, in this run or an earlier one: scripts that ended early
    std::vector<std::string> callbackProblems;
    std::vector<std::string> pictures; ///< files written, including the video
    /// why log or recording end before the run, or a screenshot is missing; empty: all are complete
    std::vector<std::string> fileProblems;
    [[nodiscard]] double cutArea() const;  ///< [m^2], OpenedSurfaces::cut summed over all bodies
    [[nodiscard]] double tornArea() const; ///< [m^2], OpenedSurfaces::torn summed over all bodies
    /// Whether everything was done: no script ended early, all files are complete, and physics had not failed at the
    /// end.
    [[nodiscard]] bool complete() const { return callbackProblems.empty() && fileProblems.empty() && undoneAtEnd == 0; }
};

/// What went wrong in steps of the run, a line each, as the log says it at the end; empty: nothing did. What the run
/// could not complete is not among it: RunReport::complete().
std::vector<std::string> warnings(const RunReport& report);

/// The report as text for a person, several lines.
std::string summary(const RunReport& report);

} // namespace filasofia::runtime
