#pragma once

#include "filasofia/runtime/memory.h"
#include "filasofia/runtime/run.h"

#include "filasofia/physics/physics_server.h"
#include "filasofia/surface/duct.h"

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>

namespace filasofia::runtime {

/// The ducts of soft bodies, which follow every step.
class Ducts {
public:
    /// Any thread. Returns its index among those of the body. Error as Simulation::addDuct().
    int add(BodyId id, const surface::DuctDef& def, const physics::PhysicsServer& physics);
    /// Any thread. Error if there is no such duct. Those of removed bodies are gone.
    [[nodiscard]] surface::DuctBalance balance(BodyId id, int duct) const;
    /// All are whole, and nothing is lost. Any thread.
    void restart();

    struct Told {
        /// Posts what flows in a duct; returns false if the event is lost.
        std::function<bool(BodyId, int, const surface::DuctBalance&)> post;
        /// The vessels at a cut end, here, within this radius [m], bleed no more by the body's own law.
        std::function<void(BodyId, Vec3, double)> seal;
        /// So much [m^3] has flowed out of an end, here, onto what is within this radius [m].
        std::function<void(BodyId, Vec3, double, double)> pour;
    };
    /// After a step of physics that ended at `time` [s]: the stepping thread. Returns false if an event is lost.
    bool afterStep(std::uint64_t step, double time, physics::PhysicsServer& physics, const Told& told);
    void fill(RunReport& report) const;
    /// For saved states; between two steps.
    [[nodiscard]] Memory memory();

private:
    struct Known {
        BodyId body = {};
        int index = 0; ///< among those of the body
        std::string name = {};
        surface::Duct duct;
        std::array<double, 2> poured = {};             ///< [m^3] per cut end, not told yet
        double pourFrom = 0.0;                         ///< [s], nothing is poured before
        std::uint64_t revision = 0;                    ///< the boundary whose cut ends were sealed
        std::optional<surface::DuctBalance> told = {}; ///< what the last event said
        double tellFrom = 0.0;                         ///< [s], no event before, unless its state changes
        /// After a restart: frames whose boundary has at least this revision are from before it. 0: none is.
        std::uint64_t old = 0;
    };
    struct State {
        std::vector<Known> all = {};
        double last = 0.0; ///< [s], end of the last step that was followed
    };
    static void tellEnds(double time, double dt, Known& known, const Told& told);
    static bool tell(double time, Known& known, const Told& told);
    [[nodiscard]] const Known& find(BodyId id, int duct) const;

    mutable std::mutex mutex_;
    State state_;
    std::vector<frame::Clip> clips_; ///< scratch
    std::atomic<bool> any_ = false;  ///< without ducts a step costs nothing
};

} // namespace filasofia::runtime
