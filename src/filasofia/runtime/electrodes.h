#pragma once

#include "filasofia/runtime/surface_layers.h"

#include "filasofia/surface/electrode_def.h"

#include <set>

namespace filasofia::runtime {

/// The electrodes of rigid bodies. Before each step of a body's heat, an active one gives the energy of the time since
/// the last to what its tip touches.
class Electrodes {
public:
    /// Any thread. Returns its index among those of the body. Error as Simulation::addElectrode().
    int add(BodyId id, const surface::ElectrodeDef& def, const physics::PhysicsServer& physics);
    struct Moved {
        bool moved = false;            ///< false: the pedal was there already
        std::optional<bool> cuts = {}; ///< whether the body's blades cut from now on; nothing: as before
    };
    /// Any thread. Error if there is no such electrode.
    Moved activate(BodyId id, bool on, int electrode);
    /// Any thread. Error if there is no such electrode.
    [[nodiscard]] surface::EnergyBalance balance(BodyId id, int electrode) const;
    [[nodiscard]] int count(BodyId id) const;
    /// Bodies whose blades cut because a pedal is pressed.
    [[nodiscard]] std::vector<BodyId> cutting() const;
    /// All pedals are released, and nothing has been given. Any thread.
    void restart();

    /// Posts what an electrode has done; returns false if the event is lost.
    using Post = std::function<bool(BodyId, int, bool, const surface::EnergyBalance&)>;
    /// After a step of physics that ended at `time` [s], and before that of the heat: the stepping thread. Returns
    /// false if an event is lost.
    bool afterStep(std::uint64_t step, double time, physics::PhysicsServer& physics, Burnings& burnings,
                   const Post& post);
    /// What an electrode has given since it was added or reset, whether to tissue or not.
    struct Given {
        std::size_t electrode = 0; ///< among all
        Vec3 place = {};           ///< [m], the middle of its tip
        double energy = 0.0;       ///< [J]
    };
    /// By all electrodes whose bodies the frame has. Any thread.
    [[nodiscard]] std::vector<Given> given(const frame::Frame& frame) const;
    [[nodiscard]] bool any() const { return any_; }
    /// After burnings.fill().
    void fill(RunReport& report, const Burnings& burnings) const;
    /// For saved states; between two steps.
    [[nodiscard]] Memory memory();

private:
    struct Electrode {
        BodyId body = {};
        int index = 0; ///< among those of the body
        std::string name = {};
        surface::ElectrodeDef def = {};
        bool active = false;
        surface::EnergyBalance balance = {};
        double seen = 0.0;                   ///< [s], the part of balance.active in which it is known what it touched
        std::map<BodyId, double> spent = {}; ///< [s], the part of balance.active before the last step of a body's heat
        std::optional<bool> told = {};       ///< what the last event said of `active`
        surface::EnergyBalance toldOf = {};  ///< what the last event said
        double tellFrom = 0.0;               ///< [s], no event before, unless a pedal moves
        /// Whether it was active at a time that has not yet come to a step of the heat of every body.
        [[nodiscard]] bool owes() const;
    };
    struct State {
        std::vector<Electrode> all = {};
        double last = 0.0; ///< [s], end of the last step
    };
    void touch(const frame::Frame& frame, const std::vector<Burnings::Surface>& surfaces, Burnings& burnings,
               const physics::PhysicsServer& physics);
    static bool tell(double time, Electrode& electrode, const Post& post);
    [[nodiscard]] std::size_t find(BodyId id, int electrode) const;

    mutable std::mutex mutex_;
    State state_;
    std::set<std::pair<BodyId, BodyId>> looked_; ///< instrument and tissue whose mesh was looked at: it is told once
    std::atomic<bool> any_ = false;              ///< without electrodes a step costs nothing
    std::atomic<double> now_ = 0.0;              ///< [s], end of the last step, with or without electrodes
};

} // namespace filasofia::runtime
