#pragma once

#include "filasofia/core/error.h"
#include "filasofia/event/event_dispatcher.h"
#include "filasofia/event/input_events.h"
#include "filasofia/physics/physics_server.h"
#include "filasofia/runtime/bleeding_event.h"
#include "filasofia/runtime/break_event.h"
#include "filasofia/runtime/burn_event.h"
#include "filasofia/runtime/clip_event.h"
#include "filasofia/runtime/contact_event.h"
#include "filasofia/runtime/device_event.h"
#include "filasofia/runtime/distension_event.h"
#include "filasofia/runtime/duct_event.h"
#include "filasofia/runtime/energy_event.h"
#include "filasofia/runtime/file_failed_event.h"
#include "filasofia/runtime/follow.h"
#include "filasofia/runtime/intersection_event.h"
#include "filasofia/runtime/memory.h"
#include "filasofia/runtime/paint.h"
#include "filasofia/runtime/run.h"
#include "filasofia/runtime/rupture_event.h"
#include "filasofia/runtime/show.h"
#include "filasofia/visual/endoscope_look.h"
#include "filasofia/visual/orbit_camera.h"
#include "filasofia/window/window.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

namespace filasofia::engine {
class Native;
}

namespace filasofia::runtime {

/// How physics is paced.
struct PhysicsDef {
    double rate = 1000.0;             ///< [Hz], in [1, 100000], steps per second
    double slack = 2e-3;              ///< [s], in [0, 10], t_s: a step is never longer than 1/rate + slack
    Vec3 gravity = {0.0, -9.81, 0.0}; ///< [m/s^2]
    bool realTime = true;             ///< ask the system to schedule physics before ordinary threads
    /// [-], in [1, 256], threads at work within one step; not given: one less than the cores, up to 8
    std::optional<int> threads = {};
    physics::ContactMethod contact = physics::ExactContact{}; ///< how bodies that touch push each other
    /// [s], > 0, time after a live step's start at which solvers stop; not given: 1/rate
    std::optional<double> deadline = {};
};
constexpr auto fields(const PhysicsDef*)
{
    using T = PhysicsDef;
    return describe(
        "PhysicsDef", field("rate", &T::rate, "Hz", closed(1, 100000), "steps per second"),
        field("slack", &T::slack, "s", closed(0, 10), "a step is never longer than 1/rate + slack"),
        field("gravity", &T::gravity, "m/s^2", finite(), "acts on every body"),
        field("realTime", &T::realTime, "schedule physics before ordinary threads"),
        field("threads", &T::threads, "-", closed(1, 256), "threads at work within one step"),
        field("contact", &T::contact, "how bodies that touch push each other"),
        field("deadline", &T::deadline, "s", positiveOrInfinite(), "time after a step's start at which solvers stop"));
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
                    field("quality", &T::quality, "quality of the effects"),
                    field("rate", &T::rate, "Hz", closed(1, 1000), "pictures per second at most"),
                    field("mouse", &T::mouse, "a person turns the look's camera"),
                    field("keys", &T::keys, "the keys of a live run work"));
}

struct SimulationDef {
    PhysicsDef physics = {};
    window::WindowDef window = {};
    LookDef look = {};
    std::string engine = {}; ///< the physics engine, by name (runtime/engines.h); empty: "native"
};
constexpr auto fields(const SimulationDef*)
{
    using T = SimulationDef;
    return describe("SimulationDef", field("physics", &T::physics, "how physics is paced"),
                    field("window", &T::window, "the window of a live run"), field("look", &T::look, "the picture"),
                    field("engine", &T::engine, "the physics engine, by name; empty: native"));
}

/// A whole simulator: the physics server, the visual server, the events and their threads.
///
/// run() belongs to the main thread. Functions that add, remove or change something may be called from any thread,
/// before and during a run. If a call is wrong, it throws an Error at once.
class Simulation {
public:
    Simulation() : Simulation(SimulationDef{}, nullptr) {}
    explicit Simulation(const SimulationDef& def) : Simulation(def, nullptr) {}
    ~Simulation();
    Simulation(Simulation&) = delete; ///< not const: `Simulation sim({})` means the default Def
    Simulation& operator=(const Simulation&) = delete;

    BodyId add(physics::SoftBodyDef def);
    BodyId add(physics::RigidBodyDef def);
    BodyId add(physics::RodBodyDef def);
    /// Lets a haptic device control a rigid element, or only be read; call it before a run. The second form takes a
    /// driver of the caller's in place of the Def's device.
    HapticId add(const HapticInterfaceDef& def);
    HapticId add(const HapticInterfaceDef& def, std::unique_ptr<device::HapticDevice> own);
    /// The state of a haptic interface now, or at the end of the last run.
    [[nodiscard]] HapticState haptic(HapticId id) const;
    /// Changes place and scale of its device in the scene; the force ramps in again.
    void placeHaptic(HapticId id, double scale, const Pose& origin);
    /// Draws a body; call it several times for several surfaces. Without a surface it draws a soft body's boundary, or
    /// the mesh of a rigid body at each of its elements (Error if it has none).
    ShownId show(BodyId id, const ShowDef& def = {});
    /// These change what show() made, from the next picture on. Error if the id was never given; nothing happens if
    /// what it names is gone.
    void setVisible(ShownId id, bool visible);
    void setMaterial(ShownId id, const visual::Material& material);
    /// It is no longer drawn, and never again.
    void unshow(ShownId id);
    /// Paints a mark (blood, burn, wetness) on everything that is drawn of a body. Returns how many vertices it
    /// reached. Costs the caller's thread about 0.1 ms for 10,000 vertices.
    int paint(BodyId id, const PaintDef& def);
    /// Makes a soft body bleed where cuts and tears open it, under the gravity of the simulation's Def. What is drawn
    /// of it shows the blood. Error if it is no soft body, or bleeds already.
    void bleed(BodyId id, const surface::BleedingDef& def = {});
    /// Makes a soft body warm and burn where it is heated. What is drawn of it shows the burns, and what is burnt does
    /// not bleed. Error if it is no soft body, or burns already.
    void burn(BodyId id, const surface::BurningDef& def = {});
    /// Presses, injures, seals, sucks or rinses a body that bleeds, or heats one that burns, from the next step of its
    /// blood or heat on.
    void treat(BodyId id, const surface::Treatment& treatment);
    /// The Error that treat() would throw, without its effect.
    void checkTreat(BodyId id, const surface::Treatment& treatment) const;
    /// Makes a rigid body, or a part of it, an electrode; returns its index among those of the body. It is off. The
    /// blades of a body with an electrode that cuts no longer do unless it is active. Error if it is no rigid body, if
    /// there is no such element, if one that cuts has no blade, or if a field is wrong.
    int addElectrode(BodyId id, const surface::ElectrodeDef& def);
    /// Presses its pedal or releases it, from the next step on. Error if there is no such electrode.
    void activate(BodyId id, bool on, int electrode = 0);
    /// What an electrode has done, up to the last step of the heat that has ended.
    [[nodiscard]] surface::EnergyBalance energy(BodyId id, int electrode = 0) const;
    [[nodiscard]] int electrodes(BodyId id) const; ///< [-], how many a body has
    /// Says that something flows in a tube of a soft body: see surface::DuctDef; returns its index among those of the
    /// body. If the body bleeds, what clips shut does not: a cut end that they shut is sealed. Error if it is no soft
    /// body of tetrahedra, or if a field is wrong.
    int addDuct(BodyId id, const surface::DuctDef& def);
    /// What flows in a duct, as the last step left it. Error if there is no such duct.
    [[nodiscard]] surface::DuctBalance duct(BodyId id, int duct = 0) const;
    /// Lets what burns smoke, in a room that holds it: see surface::SmokeDef. Pictures show it. Error if the simulation
    /// has such a room already, or if a field is wrong.
    void addSmoke(const surface::SmokeDef& def);
    /// Sucks smoke away, from its next step on. Error if there is no room for it, no such rigid body or element, if the
    /// place of an opening that no body carries is outside the room, or if a field is wrong.
    void extract(const surface::Extract& command);
    /// The Error that extract() would throw, without its effect.
    void checkExtract(const surface::Extract& command) const;
    /// What has become of the smoke, up to its last step. Error if there is no room for it.
    [[nodiscard]] surface::SmokeBalance smoke() const;
    /// The optical depth [-] of the smoke on the straight way between two points: exp(-depth) of the light passes.
    /// Error if there is no room for it, or if a point is not finite.
    [[nodiscard]] double smokeBetween(Vec3 from, Vec3 to) const;
    /// A fluid distends a cavity: see surface::DistensionDef. What bleeds clouds it, electrodes make bubbles in it, and
    /// pictures show both. Error if the simulation has one or smoke already, or if a field is wrong.
    void addDistension(const surface::DistensionDef& def);
    /// Turns its pump and taps, from its next step on. Error if there is none, or if a field is wrong.
    void distend(const surface::Distend& command);
    /// The Error that distend() would throw, without its effect.
    void checkDistend(const surface::Distend& command) const;
    /// What has become of the fluid, up to its last step. Error if there is none.
    [[nodiscard]] surface::DistensionBalance distension() const;
    /// What has become of its blood, up to the last step of the film that has ended.
    [[nodiscard]] surface::BloodBalance blood(BodyId id) const;
    /// What has become of its heat, and how much of it is burnt, up to the last step of the heat that has ended.
    [[nodiscard]] surface::HeatBalance heat(BodyId id) const;
    [[nodiscard]] bool bleeds(BodyId id) const; ///< whether bleed() was called for it
    [[nodiscard]] bool burns(BodyId id) const;  ///< whether burn() was called for it
    [[nodiscard]] bool hasSmoke() const;        ///< whether there is a room for smoke
    /// [-], Arrhenius' omega per node of a body that burns, negative where there is no surface: at 1 and beyond it is
    /// burnt. Up to the last step of the heat that has ended; null before the first one. Error if it does not burn.
    [[nodiscard]] std::shared_ptr<const std::vector<float>> damage(BodyId id) const;

    /// Makes a light, camera or other Transform of the visual server follow a body until unfollow(), its end, the
    /// body's end, or until it gets a parent; then it stays where it is. Main thread only, while there is a visual
    /// server: from inside the function given to dress().
    void follow(visual::Transform& transform, BodyId id, const FollowDef& def = {});
    void unfollow(visual::Transform& transform);
    /// Lets the person at the window move a camera, or the rig that carries it, in place of the one before. It must
    /// not have a parent. Call it from inside the function given to dress(), as follow().
    void steer(visual::Transform& camera, const visual::OrbitDef& def);

    /// Writes the next picture to a PNG file; without a name, to the next free filasofia_001.png of the working folder.
    /// Outside a run it takes the next run's first picture. Error at once if there can be no such file; later problems
    /// are logged.
    void screenshot(const std::string& file = {});

    void pause(bool paused);
    [[nodiscard]] bool paused() const; ///< in the last step
    /// Makes one step if the simulation is paused.
    void singleStep();
    /// Puts the bodies back to their start at the next step, removes all paint, blood, heat, burns and smoke, releases
    /// all pedals, and turns pump and taps of a distension back.
    void reset();

    /// The function is called on the main thread as soon as there is a visual server, in place of the look of the Def;
    /// it makes lights, cameras and views. Set it before a run (Error during one). Several functions are called in
    /// order, and {} removes them all.
    void dress(std::function<void(visual::VisualServer&)> scene);
    /// Shows a Gui over the whole window, whatever the look. Set it before a run; several are drawn in order. Throws an
    /// Error if the Def is wrong.
    void show(const visual::GuiDef& def);
    /// Opens the window of live runs in place of window::openWindow: one of another library, or one that nobody sees.
    /// Set it before a run.
    void useWindow(std::function<std::unique_ptr<window::Window>(const window::WindowDef&)> open);

    /// Calls `callback` for every event of a type, on the dispatcher's thread; in a headless run after each step.
    template <event::TypedEvent E> event::ObserverId on(std::function<void(const E&)> callback)
    {
        return events().on<E>(std::move(callback));
    }
    /// Calls `callback` on the stepping thread before every step that is not paused, live and headless, with the
    /// simulated time [s] at which that step will end. Commands that it gives belong to that step and are recorded, so
    /// a scripted motion is exact: the body is where the callback says for that time. Physics waits for the callback.
    /// If it throws, that is logged and it is not called again. Set it before a run or between two steps of a
    /// SteppedRun (Error otherwise); several are called in order.
    void everyStep(std::function<void(double time)> callback);
    /// Lets saved states of a SteppedRun have what a part of the program remembers from step to step. Set it before a
    /// run or between two steps of a SteppedRun (Error otherwise, or if the name or a function is missing). States that
    /// were saved before do not know it.
    void remember(Memory memory);
    /// Posts an event, stamped with the simulation's time and step. Any thread. Error if the queue is full.
    void post(std::unique_ptr<event::Event> event);
    template <event::EventClass E> void post(E event) { post(std::make_unique<E>(std::move(event))); }
    [[nodiscard]] event::EventDispatcher& events();
    [[nodiscard]] physics::PhysicsServer& physics();
    /// Chooses the physics engine by its name, in place of the Def's: the option --engine of every simulator. What was
    /// added is built again. Throws an Error if there is no such engine, if it refuses a body or a command, or after
    /// the first step; nothing has changed then. No other thread may use the simulation meanwhile.
    void useEngine(const std::string& name);
    /// Fine-tuning of the native engine: see filasofia/engine/native/native.h.
    void tune(std::function<void(engine::Native&)> change);

    /// Ends the run, from any thread; the report says why. Between two runs it ends the next one at once.
    void finish(std::string why);

    /// Runs until finish(), the end that `def` asks for, Ctrl-C, or until the window is closed. Throws an Error, also
    /// if this simulation is already running (so from inside an observer or a tune).
    RunReport run(const RunDef& def);
    /// The same for a main(): reads --headless, --steps N, --picture FILE.png and more (--help), and prints the report.
    /// Returns the exit code: 0; 1 if a function of everyStep() threw, or if log or recording is incomplete because
    /// the disk is full; 2 after one line that says what is wrong.
    int run(int argc, const char* const* argv);

    struct Impl;

private:
    friend class Rewind;
    friend class SteppedRun;
    Simulation(const SimulationDef& def, std::nullptr_t);

    std::unique_ptr<Impl> impl_;
};

/// For a main(): prints what was wrong, in one line, and returns the exit code 2.
int report(const Error& error);

} // namespace filasofia::runtime
