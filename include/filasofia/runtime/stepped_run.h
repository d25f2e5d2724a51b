#pragma once

#include "filasofia/physics/physics_server.h"
#include "filasofia/runtime/memory.h"
#include "filasofia/runtime/run.h"
#include "filasofia/visual/camera.h"
#include "filasofia/visual/depth_image.h"
#include "filasofia/visual/image.h"
#include "filasofia/window/window.h"

#include <memory>
#include <optional>
#include <string>

namespace filasofia::runtime {

class Simulation;

/// A picture of a stepped run, from the look of the simulation or from a place of one's own.
struct PictureDef {
    int width = 640;  ///< [px], in [1, 8192]
    int height = 480; ///< [px], in [1, 8192]
    /// Where the camera is and what it sees; the look's light goes with it. Not given: as the look or dress() placed
    /// it.
    std::optional<Pose> pose = {};
    std::optional<visual::CameraDef> camera = {}; ///< its lens; not given: the look's
};
constexpr auto fields(const PictureDef*)
{
    using T = PictureDef;
    return describe("PictureDef", field("width", &T::width, "px", closed(1, 8192), "size of the picture"),
                    field("height", &T::height, "px", closed(1, 8192), "size of the picture"),
                    field("pose", &T::pose, "pose of the camera; none: that of the look"),
                    field("camera", &T::camera, "lens of the camera; none: that of the look"));
}

/// A window in which a person watches a stepped run.
struct ViewerDef {
    window::WindowDef window = {};
    visual::Backend backend = visual::Backend::Window;
    double rate = 60.0; ///< [1/s], in [1, 1000], pictures per second
};
constexpr auto fields(const ViewerDef*)
{
    using T = ViewerDef;
    return describe("ViewerDef", field("window", &T::window, "title and size"),
                    field("backend", &T::backend, "where the pictures go"),
                    field("rate", &T::rate, "1/s", closed(1, 1000), "pictures per second"));
}

/// What a stepped run returns to with restore(). It lives in memory and never changes; any thread may use it.
struct RunState {
    std::shared_ptr<const physics::SavedState> physics;
    Memories memories;  ///< what was given to Simulation::remember()
    std::string reason; ///< given to Simulation::finish(); empty: none was
};

/// A headless run that its owner drives: step() makes one step and delivers its events. For programs that have a loop
/// of their own: learning, optimisation, bindings to other languages. With the same calls before each step the states
/// are those of a headless Simulation::run(), bit for bit.
///
/// While it exists, it is the simulation's run: no other can begin, and dress() and haptic interfaces must be set
/// before; everyStep() and remember() may also be called between two steps. Its functions may be called from any
/// thread, but from one at a time. The simulation must outlive it. Simulation::finish() does not end it; its owner
/// does.
class SteppedRun {
public:
    /// Begins the run. It reads these fields of `def`: log, record, seed, session, trainee, device, motion and
    /// recordMotion. Throws an Error if the Def asks for anything else, if a file cannot be opened, or if a run is
    /// going on; then another one may begin, also a recorded one.
    explicit SteppedRun(Simulation& simulation, const RunDef& def = {});
    /// Ends the run, if end() has not; what goes wrong is logged.
    ~SteppedRun();
    SteppedRun(const SteppedRun&) = delete;
    SteppedRun& operator=(const SteppedRun&) = delete;

    /// One step of one period. Error if the run has ended.
    physics::StepReport step();
    /// Draws the present state off screen. The first picture starts the renderer on a thread of its own, which later
    /// pictures use, and fixes the look: what it frames is what is shown then. Throws an Error if nothing can be drawn.
    visual::Image picture(const PictureDef& def = {});
    /// Depth and body of each pixel of such a picture: the labels are BodyId::value, 0 where there is none. Effects and
    /// materials do not change it, but it goes through endoscope optics as the picture does. Error like picture().
    visual::DepthImage depth(const PictureDef& def = {});
    /// Opens a window that shows the newest state, drawn on the thread of the pictures at its own rate: the owner steps
    /// as before, and the same bits come out. The mouse turns the camera, Escape closes the window, F12 takes a
    /// screenshot. It frames what is shown when it opens. Throws an Error if there is no display, if nothing is shown,
    /// or if a viewer is open.
    void openViewer(const ViewerDef& def = {});
    /// Draws the present state into the viewer at once, for an owner who wants every state to be seen.
    void showInViewer();
    void closeViewer();
    /// Whether a viewer is open; its window may have been closed by the person. Any thread.
    [[nodiscard]] bool viewing() const;
    /// The present state, in memory: bodies, cut meshes, contacts, attachments, time, the commands that wait for the
    /// next step, and what the parts of the simulator remember (tasks, jaws, trackers, commands of scenes). Error if a
    /// body, a material or a tune() waits: make a step first.
    [[nodiscard]] std::shared_ptr<const RunState> save();
    /// Returns at once to a state of this simulation, or of another one with the same bodies, parts, rate and contact
    /// method. The steps that follow have the bits of those that followed save(), if they get the same commands. Paint,
    /// the counts of the report and what functions of everyStep() remember do not go back, unless
    /// Simulation::remember() says how. Error, and nothing has changed, if bodies differ, if the state does not know a
    /// part, if the run is written to a file, or if there is a haptic interface: a hand does not go back.
    void restore(const RunState& state);
    /// How the run went until now; without the times of single steps.
    [[nodiscard]] RunReport report() const;
    /// Ends the run: closes its files and the renderer, and returns the report. Error if it has ended.
    RunReport end();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::runtime
