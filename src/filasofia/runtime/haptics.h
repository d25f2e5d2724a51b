#pragma once

#include "filasofia/event/controller_event.h"
#include "filasofia/runtime/clock.h"
#include "filasofia/runtime/device_event.h"
#include "filasofia/runtime/person_input.h"
#include "filasofia/runtime/simulation.h"

#include <atomic>
#include <map>
#include <mutex>

namespace filasofia::physics {
class PhysicsServer;
struct StepReport;
} // namespace filasofia::physics

namespace filasofia::runtime {

/// All haptic interfaces of a simulation: devices and their servos on one side, commands to physics on the other.
class Haptics {
public:
    using Post = std::function<void(std::unique_ptr<DeviceEvent>)>;

    Haptics();
    ~Haptics();

    /// Throws an Error if the Def is wrong, the device cannot be used, or the body already has an interface. `own` is a
    /// driver of the caller's, in place of the Def's device.
    HapticId add(const HapticInterfaceDef& def, std::unique_ptr<device::HapticDevice> own,
                 const physics::PhysicsServer& physics);
    [[nodiscard]] HapticState state(HapticId id) const; ///< any thread; Error if there is no such interface
    /// Moves the device to another place in the scene. Any thread.
    void place(HapticId id, double scale, const Pose& origin);
    [[nodiscard]] std::vector<HapticId> ids() const;
    [[nodiscard]] HapticInterfaceDef def(HapticId id) const; ///< as it is placed now
    [[nodiscard]] MotionState deviceHand(HapticId id) const; ///< along the device's own axes

    // A run. No interface can be added between begin() and end().
    /// Throws an Error if the device or motion file that the run asks for cannot be used. In a headless run the servos
    /// tick at their rates in simulated time, within each step and last at its end, so that every run gives the same
    /// result.
    void begin(const RunDef& run, const PhysicsDef& physics, const Clock& clock, const Post& post);
    /// Physics was reset: hands without an origin of their own take their bodies from where these start. Any thread.
    void realign(physics::PhysicsServer& physics);
    /// Before a step of dt [s] that is not paused and will end at `end` [s], on the stepping thread.
    void beforeStep(double dt, double end, physics::PhysicsServer& physics);
    /// After every step, on the stepping thread.
    void afterStep(const physics::StepReport& report, physics::PhysicsServer& physics);
    /// Writes the motion that was recorded since the last call. Main thread.
    void drain();
    /// Stops the servos and leaves no force on any hand. Throws an Error if the motion file cannot be closed.
    void end();
    void abandon() noexcept; ///< the same after another error
    /// Returns true if the input was for a device, and so for nobody else. Main thread.
    bool handle(const event::Event& event);

private:
    struct Interface;
    [[nodiscard]] Interface& find(HapticId id) const;
    bool handleController(const event::ControllerEvent& event);
    void tickThrough(Interface& each, double dt, double end);
    void align(Interface& each, const device::ServoSnapshot& seen, physics::PhysicsServer& physics);

    /// Guards the list and its servos; steps do not wait for it, because the list does not change during a run.
    mutable std::mutex mutex_;
    std::vector<std::unique_ptr<Interface>> interfaces_;
    Clock clock_;
    bool live_ = false;
    bool running_ = false;
    std::atomic<device::Nanoseconds> simulated_ = 0; ///< the clock of a headless run's devices
    device::Nanoseconds wake_ = 0;                   ///< when the step being made woke up
    PersonInputReader person_;
    std::unique_ptr<SpscRing<device::MotionSample>> tape_;
    std::optional<device::MotionWriter> motion_;
};

} // namespace filasofia::runtime
