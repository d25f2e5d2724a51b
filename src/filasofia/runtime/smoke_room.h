#pragma once

#include "filasofia/runtime/memory.h"
#include "filasofia/runtime/run.h"
#include "filasofia/runtime/surface_layers.h"

#include "filasofia/surface/smoke.h"
#include "filasofia/visual/smoke.h"

#include <atomic>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

namespace filasofia::runtime {

/// The room in which what burns smokes. It steps on the stepping thread: it has some dozen puffs.
class SmokeRoom {
public:
    /// Any thread. Error as Simulation::addSmoke().
    void add(const surface::SmokeDef& def, Vec3 gravity);
    /// Any thread. Error as Simulation::extract().
    void check(const surface::Extract& command, const physics::PhysicsServer& physics) const;
    /// Takes effect at the smoke's next step. Any thread. Error as Simulation::extract().
    void extract(const surface::Extract& command, const physics::PhysicsServer& physics);
    [[nodiscard]] bool any() const { return any_; }
    [[nodiscard]] surface::SmokeBalance balance() const;  ///< any thread; Error without a room
    [[nodiscard]] double depth(Vec3 from, Vec3 to) const; ///< the same
    /// The air is clear, and nothing is extracted. Any thread.
    void restart();
    /// After a step of physics that ended at `time` [s], and after that of the heat: the stepping thread.
    void afterStep(std::uint64_t step, double time, physics::PhysicsServer& physics, Burnings& burnings);
    void showAgain(); ///< to a picture that has nothing of it yet
    /// What is seen of it, if that has changed since the last call.
    [[nodiscard]] std::optional<visual::Smoke> takePicture();
    void fill(RunReport& report) const;
    /// For saved states; between two steps.
    [[nodiscard]] Memory memory();

private:
    /// The room, and what a step of it needs.
    struct Room {
        surface::Smoke smoke;
        surface::Smoke start; ///< as it was added
        Vec3 gravity = {};
        std::map<int, surface::Extract> openings = {}; ///< by their numbers
        double last = -1.0;                            ///< [s], end of its last step; < 0: there was none
        double next = 0.0;                             ///< [s]
    };
    struct State {
        std::vector<Room> all = {}; ///< at most one
    };
    [[nodiscard]] const Room& room() const;

    mutable std::mutex mutex_;
    State state_;
    std::atomic<bool> any_ = false; ///< without a room a step costs nothing
    bool fresh_ = false;            ///< takePicture() does not have it yet
    bool shown_ = false;            ///< the picture has something of it
};

} // namespace filasofia::runtime
