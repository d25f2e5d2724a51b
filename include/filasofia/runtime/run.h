#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/runtime/timing.h"
#include "filasofia/visual/visual_server.h"

#include <string>

namespace filasofia::runtime {

/// How a simulation is run.
struct RunDef {
    bool headless = false; ///< a plain loop of steps of one period each: no threads, no clock, the same every time
    visual::Backend backend = visual::Backend::Window; ///< where a live run draws
    int steps = 0;                                     ///< [-], >= 0, ends after as many; 0: no end of its own
    double seconds = 0.0;      ///< [s], in [0, 1e8], wall time after which a live run ends; 0: no end of its own
    std::string picture = {};  ///< a PNG file for the last state; empty: none
    double pictureEvery = 0.0; ///< [s], 0 or >= 1e-3, headless: numbered pictures instead, simulated time apart
    std::string log = {};      ///< a CSV file with a line per step; empty: none
    std::string record = {};   ///< a .rec file for `filasofia replay`, of a simulation's first run; empty: none
    bool freeRunning = false;  ///< a live run that does not wait between steps: measures what they cost
    std::string video = {};    ///< an MP4 file, made by the program ffmpeg; empty: none
    std::string device =
        {}; ///< the first haptic interface's, in place of its own: NAME, or NAME:LIBRARY; empty: its own
    std::string motion = {};       ///< a motion file that is played in place of that device; empty: none
    std::string recordMotion = {}; ///< a motion file for what is done with the first haptic interface; empty: none
    double fps = 30.0;        ///< [1/s], in [1, 240], pictures of the video: simulated time headless, else wall time
    int seed = 0;             ///< [-], >= 0, for the recording: of what your program draws by chance
    std::string session = {}; ///< for the recording: what the run is called; any text
    std::string trainee = {}; ///< for the recording: who is at it; any text
};
constexpr auto fields(const RunDef*)
{
    using T = RunDef;
    return describe("RunDef", field("headless", &T::headless, "a plain loop with fixed steps"),
                    field("backend", &T::backend, "where a live run draws"),
                    field("steps", &T::steps, "-", nonNegative(), "ends after as many"),
                    field("seconds", &T::seconds, "s", closed(0, 1e8), "ends after this wall time"),
                    field("picture", &T::picture, "a PNG file for the last state"),
                    field("pictureEvery", &T::pictureEvery, "s", nonNegative(), "between numbered pictures"),
                    field("log", &T::log, "a CSV file with a line per step"),
                    field("record", &T::record, "a file from which the run can be made again"),
                    field("freeRunning", &T::freeRunning, "does not wait between steps"),
                    field("video", &T::video, "an MP4 file"),
                    field("device", &T::device, "the first haptic interface's"),
                    field("motion", &T::motion, "a motion file played in place of a device"),
                    field("recordMotion", &T::recordMotion, "a motion file for what is done"),
                    field("fps", &T::fps, "1/s", closed(1, 240), "pictures of the video"),
                    field("seed", &T::seed, "-", nonNegative(), "for the recording: of what is drawn by chance"),
                    field("session", &T::session, "for the recording: what the run is called"),
                    field("trainee", &T::trainee, "for the recording: who is at it"));
}

/// How two bodies touched in a run.
struct ContactPairReport {
    std::string first, second;      ///< their names
    std::uint64_t steps = 0;        ///< [-], in which they touched; the means are over these
    double meanNormalForce = 0.0;   ///< [N], the sum over their contacts
    double maxNormalForce = 0.0;    ///< [N], of a step
    double meanFrictionForce = 0.0; ///< [N], the sum of the sizes over their contacts
    double maxFrictionForce = 0.0;  ///< [N], of a step
    double deepest = 0.0;           ///< [m], >= 0, that they were inside each other at a step's start
};

/// How a run went.
struct RunReport {
    RunTiming timing;
    visual::VisualStatistics visual;         ///< zeros where nothing was drawn
    double time = 0.0;                       ///< [s], simulated since the simulation began
    std::uint64_t steps = 0;                 ///< [-], made since the simulation began
    std::uint64_t hash = 0;                  ///< of the last state
    std::uint64_t undone = 0;                ///< steps in which a body was put back (StepFlag::Undone)
    std::uint64_t damped = 0;                ///< of these, made again from rest, damped (StepFlag::Damped)
    std::uint64_t notConverged = 0;          ///< steps in which a solver reached its cap
    std::uint64_t outOfTime = 0;             ///< steps in which a solver stopped at the deadline (StepFlag::OutOfTime)
    bool realTime = false;                   ///< physics was scheduled before ordinary threads
    std::string finished;                    ///< why it ended
    std::vector<ContactPairReport> contacts; ///< one per pair of bodies that touched, ascending by their ids
    std::vector<std::string> pictures;       ///< files written, the video too
    std::vector<std::string>
        fileProblems; ///< why log or recording end before the run, or a screenshot is missing; empty: all whole
};

/// The report as a person reads it, several lines.
std::string summary(const RunReport& report);

} // namespace filasofia::runtime
