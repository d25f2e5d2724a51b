#pragma once

#include "filasofia/runtime/bindings.h"
#include "filasofia/runtime/clock.h"
#include "filasofia/runtime/contact_watch.h"
#include "filasofia/runtime/haptics.h"
#include "filasofia/runtime/scene_journal.h"
#include "filasofia/runtime/simulation.h"
#include "filasofia/runtime/step_feed.h"

#include <atomic>
#include <mutex>

namespace filasofia::runtime {

/// A camera in a person's hand.
struct Steering {
    visual::OrbitCamera orbit;
    visual::Transform* transform = nullptr;
    std::weak_ptr<const void> life = {};
};

/// What a Simulation is made of; the run modes work on it.
struct Simulation::Impl {
    SimulationDef def;
    Clock clock = steadyClock();
    physics::PhysicsServer physics;
    event::EventDispatcher events;
    Bindings bindings;
    std::vector<std::function<void(visual::VisualServer&)>> dresses;
    std::vector<visual::GuiDef> guis; ///< over the window
    std::function<std::unique_ptr<window::Window>(const window::WindowDef&)> openWindow;
    std::optional<Steering> steering;                   ///< the main thread's in a run
    std::vector<std::function<void(double)>> everyStep; ///< an empty one threw; the stepping thread's in a run
    ContactWatch contacts;                              ///< the stepping thread's in a run
    Haptics haptics;                                    ///< after physics and events, which its threads talk to

    StepFeed feed;        ///< to the inspector
    SceneJournal journal; ///< for the recording of the first run
    std::mutex screenshotMutex;
    std::vector<std::string> screenshots;     ///< asked for and not taken
    std::vector<std::string> pictures;        ///< files that the run has written; the main thread's
    std::vector<std::string> pictureProblems; ///< of screenshots; the main thread's
    std::vector<std::string> fileProblems;    ///< of those that a line per step goes into; read when the run has ended

    std::atomic<bool> paused = false;    ///< in the last step
    std::atomic<bool> stepAsked = false; ///< one, while paused
    bool stepping = false;               ///< it is being made; the stepping thread's
    bool pauseComes = false;             ///< with the next step; the stepping thread's
    std::atomic<bool> running = false;   ///< run() is going on, on whatever thread
    std::atomic<bool> stop = false;
    std::mutex reasonMutex;
    std::string reason; ///< why the run ends: the first that was given

    // Written by the stepping thread after each step, read by whoever stamps an event.
    std::atomic<double> time = 0.0;
    std::atomic<std::uint64_t> step = 0;
    std::uint64_t everMade = 0; ///< steps of all runs, paused ones too; the stepping thread's until the run has ended
    std::uint64_t undone = 0, damped = 0, notConverged = 0, outOfTime = 0; ///< of this run; read when it has ended

    explicit Impl(const SimulationDef& asked);
    Impl(const SimulationDef& asked, std::unique_ptr<physics::PhysicsEngine> engine);

    void finish(std::string why);
    void readyAgain(); ///< after a run, however it ended
    [[nodiscard]] Nanoseconds period() const { return toNanoseconds(1.0 / def.physics.rate); }
    /// Of a live step, after its start.
    [[nodiscard]] Nanoseconds deadline() const;
    /// Time and step of now, onto an event.
    void stamp(event::Event& event) const;
    /// Into the journal, where one is kept.
    void tellScene(SceneEvent event) { journal.add(step.load(std::memory_order_relaxed), std::move(event)); }
    /// What the user does before a step of dt [s].
    void beforeStep(double dt);
    /// Posts what begins, goes on and ends to touch; StepFlag bits where some of it was lost.
    std::uint32_t tellContacts(const physics::StepReport& report);
    /// The same of what was cut and what tore.
    std::uint32_t tellRuptures(const physics::StepReport& report);
    /// Bookkeeping after a step: time, counters, contact events and the update event. Returns the flags for the next
    /// report.
    std::uint32_t afterStep(const physics::StepReport& report);
    /// The look of the Def, or what the user made of the scene.
    void dressScene(visual::VisualServer& visual);
    /// Moves the drawn bodies to the newest frame.
    void mapNewestFrame(visual::VisualServer& visual);
    /// The same once the new triangles of what was cut until then are there.
    void mapFinishedFrame(visual::VisualServer& visual);
    /// Draws the present state into a file; physics must not be stepping.
    void takePicture(visual::VisualServer& visual, const std::string& file);
    /// The bodies back to their start, and clean.
    void reset();
    void steer(visual::Transform& camera, const visual::OrbitDef& def);
    /// Remembers a file for the next picture; Error where there can be none.
    void askScreenshot(const std::string& file);
    [[nodiscard]] bool screenshotAsked();
    /// None can be taken.
    void dropScreenshots(const Error& why);
    /// Writes what is drawn now to all files that were asked for; a problem is logged.
    void takeScreenshots(visual::VisualServer& visual);
    void fill(RunReport& report);
};

/// Fails before the run, not after it: an Error "<object>: <field> ..." where there can be no such file. Empty: none.
void checkFile(const char* object, const std::string& file, const char* field, const char* extension);
/// Steps of one period in a plain loop; events are delivered between steps.
RunReport runHeadless(Simulation::Impl& parts, const RunDef& def);
/// Physics in its own thread, the picture on this one.
RunReport runLive(Simulation::Impl& parts, const RunDef& def);

} // namespace filasofia::runtime
