#pragma once

#include "filasofia/runtime/bindings.h"
#include "filasofia/runtime/blade_watch.h"
#include "filasofia/runtime/camera_steering.h"
#include "filasofia/runtime/clock.h"
#include "filasofia/runtime/contact_watch.h"
#include "filasofia/runtime/distended_cavity.h"
#include "filasofia/runtime/ducts.h"
#include "filasofia/runtime/electrodes.h"
#include "filasofia/runtime/haptics.h"
#include "filasofia/runtime/intersection_watch.h"
#include "filasofia/runtime/memory_list.h"
#include "filasofia/runtime/pause_control.h"
#include "filasofia/runtime/run_control.h"
#include "filasofia/runtime/run_counters.h"
#include "filasofia/runtime/scene_journal.h"
#include "filasofia/runtime/screenshot_queue.h"
#include "filasofia/runtime/simulation.h"
#include "filasofia/runtime/simulation_time.h"
#include "filasofia/runtime/smoke_room.h"
#include "filasofia/runtime/step_callbacks.h"
#include "filasofia/runtime/step_feed.h"
#include "filasofia/runtime/surface_layers.h"
#include "filasofia/runtime/unseen_bodies.h"
#include "filasofia/runtime/written_files.h"

#include <mutex>

namespace filasofia::runtime {

/// What the user sets before a run for its picture.
struct PictureSetup {
    std::vector<std::function<void(visual::VisualServer&)>> dresses; ///< in place of the look of the Def
    std::vector<visual::GuiDef> guis;                                ///< over the window
    std::function<std::unique_ptr<window::Window>(const window::WindowDef&)> openWindow; ///< empty: window::openWindow
    /// What is drawn if this is the newest frame; called once for each picture. Empty: that frame.
    std::function<const frame::Frame&(const frame::Frame&)> drawn;
};

/// The parts of a Simulation, each of which owns its state; the run modes work on it.
struct Simulation::Impl {
    SimulationDef def;
    Clock clock = steadyClock();
    physics::PhysicsServer physics;
    event::EventDispatcher events;
    Bindings bindings;
    Bleedings bleedings;
    Burnings burnings;
    std::mutex heatMutex; ///< held while the tissue that heat has changed is posted, and while a reset ends that
    Electrodes electrodes;
    Ducts ducts;
    SmokeRoom smoke;
    DistendedCavity distension;
    PictureSetup picture;
    CameraSteering steering;
    UnseenBodies unseen;
    StepCallbacks everyStep;
    MemoryList memories;
    ContactWatch contacts;
    IntersectionWatch intersections;
    BladeWatch blades{events, physics};
    Haptics haptics; ///< after physics and events, which its threads talk to

    StepFeed feed;        ///< to the inspector
    SceneJournal journal; ///< for the recording of the first run
    ScreenshotQueue screenshots;
    WrittenFiles files;
    PauseControl pause;
    RunControl control;
    SimulationTime now; ///< the last step's
    RunCounters counters;

    explicit Impl(const SimulationDef& asked);
    Impl(const SimulationDef& asked, std::unique_ptr<physics::PhysicsEngine> engine);

    /// The engine that a Def names. Throws an Error if it cannot be had.
    static std::unique_ptr<physics::PhysicsEngine> engineFor(const SimulationDef& def);
    void useEngine(const std::string& name);

    void beginRun();
    void endRun(); ///< after a run, however it ended, also if it could not begin
    /// [s] the step that no clock counts: exactly 1 / rate, so that a minute at 30 kHz is one.
    [[nodiscard]] double step() const { return 1.0 / def.physics.rate; }
    [[nodiscard]] Nanoseconds period() const { return toNanoseconds(step()); } ///< that of live steps
    /// How long after a live step's start its solvers stop.
    [[nodiscard]] Nanoseconds deadline() const;
    /// Adds an event to the journal if one is kept.
    void recordScene(SceneEvent event) { journal.add(now.step(), std::move(event)); }
    /// Calls haptics and the user's callbacks before a step of dt [s].
    void beforeStep(double dt);
    /// Bookkeeping after a step: time, counters, contact events and the update event. Returns the flags for the next
    /// report.
    std::uint32_t afterStep(const physics::StepReport& report);
    /// Posts an event for each pair that begins, continues or ends to touch. Returns StepFlag bits if some were lost.
    std::uint32_t postContactEvents(const physics::StepReport& report);
    /// Posts an event for each pair whose surfaces begin or cease to pass through each other. Returns StepFlag bits if
    /// some were lost.
    std::uint32_t postIntersectionEvents(const physics::StepReport& report);
    /// Posts an event for each cut and tear. Returns StepFlag bits if some were lost.
    std::uint32_t postChangeEvents(const physics::StepReport& report); ///< what was cut, clipped or let go
    /// Posts an event for each clip that was closed or slipped off. Returns StepFlag bits if some were lost.
    /// Lets blood flow, heat spread and smoke rise, and posts their events. Returns StepFlag bits if some were lost.
    std::uint32_t stepSurfaces(const physics::StepReport& report);
    /// The same for any receivers of what is told. Heat comes first: burnt vessels do not bleed. Returns false if an
    /// event is lost.
    bool stepSurfaces(std::uint64_t step, double time, const SurfaceLayers<surface::Burning>::Post& burnt,
                      const SurfaceLayers<surface::Bleeding>::Post& bled, const Electrodes::Post& given);
    /// Posts what has become of the fluid, if it is time. Returns false if the event is lost.
    bool postDistension();
    /// Changes the tissue that heat has denatured.
    void changeHeatedTissue();
    /// Lets ducts flow, closes the vessels at cut ends that clips shut, and posts their events. Returns StepFlag bits
    /// if some were lost.
    std::uint32_t stepDucts(const physics::StepReport& report);
    void treat(BodyId id, const surface::Treatment& treatment);
    /// Calls act(layers, command) with the blood or the heat of all bodies.
    template <class Act> void ofLayer(const surface::Treatment& treatment, const Act& act)
    {
        std::visit(
            [&](const auto& each) {
                if constexpr (std::is_same_v<std::decay_t<decltype(each)>, surface::Heat>)
                    act(burnings, each);
                else
                    act(bleedings, each);
            },
            treatment);
    }
    /// Goes on or pauses, as somebody says; also during a single step.
    void setPaused(bool paused)
    {
        pause.tell();
        physics.pause(paused);
    }
    /// Removes all paint, blood, heat, burns and smoke, and releases all pedals.
    void cleanSurfaces();
    /// All that is shown, where it is now; before the first step, where it starts [m].
    std::vector<Vec3> pointsNow(visual::VisualServer& visual);
    /// Makes the look of the Def, or calls the user's dress functions. The look frames, and lights, what is shown where
    /// it starts, or where it is now.
    enum class Framed { AtStart, Now };
    void dressScene(visual::VisualServer& visual, Framed framed = Framed::AtStart);
    /// Moves the drawn bodies to the newest frame.
    void mapNewestFrame(visual::VisualServer& visual);
    /// The same, after waiting for the new triangles of everything cut until then.
    void mapFinishedFrame(visual::VisualServer& visual);
    /// Draws the present state into a file; physics must not be stepping.
    void takePicture(visual::VisualServer& visual, const std::string& file);
    void takeScreenshots(visual::VisualServer& visual) { screenshots.take(visual, files); }
    /// Puts the bodies back to their start and removes all paint.
    void reset();
    void fill(RunReport& report) const;
};

} // namespace filasofia::runtime
