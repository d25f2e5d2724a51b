#pragma once

#include "filasofia/core/error.h"
#include "filasofia/event/event_dispatcher.h"
#include "filasofia/event/input_events.h"
#include "filasofia/physics/physics_server.h"
#include "filasofia/runtime/contact_event.h"
#include "filasofia/runtime/device_event.h"
#include "filasofia/runtime/file_failed_event.h"
#include "filasofia/runtime/follow.h"
#include "filasofia/runtime/paint.h"
#include "filasofia/runtime/run.h"
#include "filasofia/runtime/rupture_event.h"
#include "filasofia/runtime/show.h"
#include "filasofia/visual/endoscope_look.h"
#include "filasofia/visual/orbit_camera.h"
#include "filasofia/window/window.h"

#include <functional>
#include <memory>
#include <optional>
#include <utility>

namespace filasofia::engine {
struct Native;
}

namespace filasofia::runtime {

/// How physics is paced.
struct PhysicsDef {
    double rate = 1000.0;             ///< [Hz], in [1, 100000], steps per second
    double slack = 2e-3;              ///< [s], in [0, 10]: a step is never longer than 1/rate + slack
    Vec3 gravity = {0.0, -9.81, 0.0}; ///< [m/s^2]
    bool realTime = true;             ///< ask the system to schedule physics before ordinary threads
    std::optional<int> threads =
        {}; ///< [-], in [1, 256], at work within one step; not given: the cores but one, up to 8
    physics::ContactMethod contact = physics::ExactContact{}; ///< how bodies that touch push each other
    std::optional<double> deadline = {}; ///< [s], > 0, after a live step's start: solvers stop there; not given: 1/rate
};
constexpr auto fields(const PhysicsDef*)
{
    using T = PhysicsDef;
    return describe(
        "PhysicsDef", field("rate", &T::rate, "Hz", closed(1, 100000), "steps per second"),
        field("slack", &T::slack, "s", closed(0, 10), "a step is never longer than 1/rate + slack"),
        field("gravity", &T::gravity, "m/s^2", finite(), "acts on every body"),
        field("realTime", &T::realTime, "schedule physics before ordinary threads"),
        field("threads", &T::threads, "-", closed(1, 256), "at work within one step"),
        field("contact", &T::contact, "how bodies that touch push each other"),
        field("deadline", &T::deadline, "s", positiveOrInfinite(), "solvers stop so long after a step's start"));
}

/// The picture that a simulation has unless it makes its own: an endoscope's.
struct LookDef {
    std::optional<geometry::Box> around = {}; ///< [m], what to see; not given: everything shown, as it is at the start
    Vec3 direction = {0.25, 0.3, 1.0};        ///< [-], from there towards the camera
    visual::Quality quality = visual::Quality::High;
    double rate = 60.0; ///< [Hz], in [1, 1000], pictures per second at most
    bool mouse = true;  ///< a person turns the look's camera in a live run (visual/orbit_camera.h)
    bool keys = true;   ///< Space, N, R, P, F12, H and Escape work in a live run (runtime/keys.h); F1 always does
};
constexpr auto fields(const LookDef*)
{
    using T = LookDef;
    return describe("LookDef", field("around", &T::around, "what to see"),
                    field("direction", &T::direction, "-", finite(), "from there towards the camera"),
                    field("quality", &T::quality, "effects"),
                    field("rate", &T::rate, "Hz", closed(1, 1000), "pictures per second at most"),
                    field("mouse", &T::mouse, "a person turns the look's camera"),
                    field("keys", &T::keys, "the keys of a live run work"));
}

struct SimulationDef {
    PhysicsDef physics = {};
    window::WindowDef window = {};
    LookDef look = {};
};
constexpr auto fields(const SimulationDef*)
{
    using T = SimulationDef;
    return describe("SimulationDef", field("physics", &T::physics, "how physics is paced"),
                    field("window", &T::window, "the window of a live run"), field("look", &T::look, "the picture"));
}

/// A whole simulator: the physics server, the visual server, the events and their threads.
///
/// run() belongs to the main thread. What adds, removes or changes something may be called from any thread, before and
/// during a run, and fails with an Error at once where it is wrong.
class Simulation {
public:
    explicit Simulation(const SimulationDef& def = {});
    ~Simulation();
    Simulation(const Simulation&) = delete;
    Simulation& operator=(const Simulation&) = delete;

    BodyId add(physics::SoftBodyDef def);
    BodyId add(physics::RigidBodyDef def);
    /// Gives a rigid element into a hand: before a run. The second takes a driver of the caller's in place of the Def's
    /// device.
    HapticId add(const HapticInterfaceDef& def);
    HapticId add(const HapticInterfaceDef& def, std::unique_ptr<device::HapticDevice> own);
    /// How a haptic interface is doing now, or did in the last run.
    [[nodiscard]] HapticState haptic(HapticId id) const;
    /// Another place and size of its device in the scene; the force begins anew.
    void placeHaptic(HapticId id, double scale, const Pose& origin);
    /// Draws a body; several times for several surfaces. Without a surface: a soft body's boundary, or every element of
    /// a rigid body as its own mesh (Error where it has none).
    ShownId show(BodyId id, const ShowDef& def = {});
    /// Of what show() made, from the next picture on. An Error where the id was never given; nothing happens where what
    /// it names is gone.
    void setVisible(ShownId id, bool visible);
    void setMaterial(ShownId id, const visual::Material& material);
    /// It is no longer drawn, and never again.
    void unshow(ShownId id);
    /// Marks what is drawn of a body: blood, burn, wetness. Returns how many vertices it reached. Costs the caller's
    /// thread about 0.1 ms for 10,000 vertices.
    int paint(BodyId id, const PaintDef& def);

    /// A light, camera or other Transform of the visual server goes where a body goes, until unfollow(), its end, the
    /// body's end, or until it gets a parent; then it stays where it is. Main thread only, while there is a visual
    /// server: from where dress() is called.
    void follow(visual::Transform& transform, BodyId id, const FollowDef& def = {});
    void unfollow(visual::Transform& transform);
    /// Gives a camera, or the rig that it hangs on, into the hand of the person at the window, in place of the one that
    /// was. Without a parent. As follow(): from where dress() is called.
    void steer(visual::Transform& camera, const visual::OrbitDef& def);

    /// Writes the next picture to a PNG file; without a name to the next free filasofia_001.png of the working folder.
    /// Outside a run: the next run's first picture. An Error at once where the file cannot be; what goes wrong later is
    /// logged.
    void screenshot(const std::string& file = {});

    void pause(bool paused);
    [[nodiscard]] bool paused() const; ///< in the last step
    /// One step, where paused.
    void singleStep();
    /// The bodies back to their start, at the next step, and clean of paint.
    void reset();

    /// Called on the main thread as soon as there is a visual server, in place of the look of the Def: makes lights,
    /// cameras and views. To be set before a run (Error during one); several are called in their order, and {} forgets
    /// them all.
    void dress(std::function<void(visual::VisualServer&)> scene);
    /// A Gui over the whole window, whatever the look. To be set before a run; several lie in their order. Throws an
    /// Error where the Def is wrong.
    void show(const visual::GuiDef& def);
    /// Opens the window of live runs in place of window::openWindow: another library's, or one that nobody sees. To be
    /// set before a run.
    void useWindow(std::function<std::unique_ptr<window::Window>(const window::WindowDef&)> open);

    /// Calls `callback` for every event of a type, on the dispatcher's thread; in a headless run after each step.
    template <event::TypedEvent E> event::ObserverId on(std::function<void(const E&)> callback)
    {
        return events().on<E>(std::move(callback));
    }
    /// Calls `callback` on the stepping thread before every step that is not paused, live and headless, with the
    /// simulated time [s] at which that step will end. Commands that it makes belong to that step and are recorded:
    /// what moves by a script goes where the callback says for that time, exactly. Physics waits for it. One that
    /// throws is logged and not called again. To be set before a run (Error during one); several are called in their
    /// order.
    void everyStep(std::function<void(double time)> callback);
    /// Posts an event, stamped with the simulation's time and step. Any thread. Error where the queue is full.
    void post(std::unique_ptr<event::Event> event);
    template <event::EventClass E> void post(E event) { post(std::make_unique<E>(std::move(event))); }
    [[nodiscard]] event::EventDispatcher& events();
    [[nodiscard]] physics::PhysicsServer& physics();
    /// Fine-tuning: see filasofia/engine/native/native.h.
    void tune(std::function<void(engine::Native&)> change);

    /// Ends the run, from any thread; the report says why. Between two runs: the next one ends at once.
    void finish(std::string why);

    /// Runs until finish(), the end that `def` asks for, Ctrl-C, or the window is closed. Throws Error, also
    /// when a run of this simulation is going on (so from inside an observer or a tune).
    RunReport run(const RunDef& def);
    /// The same for a main(): reads --headless, --steps N, --picture FILE.png and more (--help), prints how it went and
    /// returns the exit code: 0; 1 where log or recording found no room on the disk; or 2 after one line that says
    /// what is wrong.
    int run(int argc, const char* const* argv);

    struct Impl;

private:
    std::unique_ptr<Impl> impl_;
};

/// For a main(): prints what was wrong, in one line, and returns the exit code 2.
int report(const Error& error);

} // namespace filasofia::runtime
