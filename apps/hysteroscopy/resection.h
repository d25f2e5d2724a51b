#pragma once

#include "apps/hysteroscopy/patient.h"

#include <mutex>

/// The case resection: a myoma is shaved off with a wire loop, chip by chip.
namespace hysteroscopy {

/// The chips that a loop shaves off a body. They float for a moment before the flow takes them away.
class Chips {
public:
    /// Construct it before a run.
    Chips(filasofia::Simulation& sim, const Patient& patient, filasofia::BodyId myoma);

    /// Called with the volume [m^3] of each chip, on the thread that delivers events.
    std::function<void(double)> onChip = {};
    [[nodiscard]] int count() const { return count_; }
    [[nodiscard]] double left() const; ///< [-], in [0, 1], the share of what was above the wall that has not come off

private:
    void take(const filasofia::CutEvent& cut);
    void rinse(double time);

    struct Chip {
        int piece = 0;
        double until = 0.0; ///< [s], when it is gone
    };
    filasofia::Simulation& sim_;
    const filasofia::BodyId myoma_;
    const double whole_; ///< [m^3], above the wall
    std::atomic<int> count_ = 0;
    std::atomic<double> removed_ = 0.0; ///< [m^3]
    std::mutex mutex_;                  // guards what follows
    std::vector<Chip> floating_;
};

/// What a live loop does to the wall: how deep it goes, and how much it burns.
class WallInjury {
public:
    /// Construct it before a run. `deep` [m] counts as a mistake, which `mistaken` is told on the stepping thread.
    WallInjury(filasofia::Simulation& sim, filasofia::BodyId wall, const filasofia::WireLoop& loop, double deep,
               std::function<void(double)> mistaken);

    [[nodiscard]] double deepest() const { return deepest_; } ///< [m], so far; any thread
    [[nodiscard]] double burnt() const { return burnt_; } ///< [m^2], what live wire has swept in the wall; any thread
    [[nodiscard]] int mistakes() const { return mistakes_; } ///< [-]; any thread
    /// [m] How deep a place is in the wall as it is now; 0: it is not. Not before the first step.
    [[nodiscard]] double depthAt(filasofia::Vec3 place) const;

private:
    void look(double time);
    [[nodiscard]] double depthIn(const std::vector<filasofia::Vec3>& wall, filasofia::Vec3 place) const;

    filasofia::Simulation& sim_;
    const filasofia::BodyId wall_;
    const filasofia::WireLoop& loop_;
    const double deep_;
    const std::function<void(double)> mistaken_;
    const filasofia::TetMesh mesh_; ///< as it was added
    const std::vector<filasofia::geometry::Triangle> skin_;
    double nextLook_ = 0.0;             ///< [s]
    double active_ = 0.0;               ///< [s], of the loop at the last look
    std::vector<filasofia::Vec3> wire_; ///< [m], where it was then
    bool within_ = false;               ///< the wire is deeper than is right
    std::atomic<double> deepest_ = 0.0, burnt_ = 0.0;
    std::atomic<int> mistakes_ = 0;
};

/// One session of the case.
int resection(const filasofia::Training& training, const Patient& patient);

} // namespace hysteroscopy
