#pragma once

#include "filasofia/runtime/simulation_impl.h"

#include <array>
#include <map>

namespace filasofia::runtime {

/// The newest values of a quantity, for a plot.
class Trace {
public:
    static constexpr int kLength = 180;
    void add(double value)
    {
        values_[std::size_t(next_)] = float(value);
        next_ = (next_ + 1) % kLength;
        count_ = std::min(count_ + 1, kLength);
    }
    [[nodiscard]] double newest() const
    {
        return count_ > 0 ? double(values_[std::size_t((next_ + kLength - 1) % kLength)]) : 0.0;
    }
    [[nodiscard]] const float* data() const { return values_.data(); }
    [[nodiscard]] int oldest() const { return count_ < kLength ? 0 : next_; } ///< index of the oldest value in data()
    [[nodiscard]] int count() const { return count_; }

private:
    std::array<float, kLength> values_ = {};
    int next_ = 0;
    int count_ = 0;
};

/// The rates of both servers, where a step's time goes, and how its solvers do.
class InspectorRates {
public:
    explicit InspectorRates(Simulation::Impl& impl) : impl_(impl) {}

    /// Forgets the time in which the panel was closed.
    void restart();
    void add(const physics::StepReport& report);
    /// Call it for each picture. Every 0.1 s becomes one point of the plots.
    void addPicture(double guiSeconds);
    void draw();

    [[nodiscard]] bool paused() const { return paused_; }
    [[nodiscard]] double physicsRate() const { return physics_.newest(); }
    /// Call it if the picture was drawn; the driver skips some.
    void countDrawn() { ++now_.pictures; }
    [[nodiscard]] double pictureRate() const { return pictures_.newest(); }

private:
    void drawStages() const;
    void drawSolvers() const;
    [[nodiscard]] std::string nameOf(BodyId id) const;

    /// Sums over the steps since the last point.
    struct Sums {
        int steps = 0;
        int moving = 0; ///< steps that were not paused
        double simulated = 0.0;
        physics::StageTimes times;
        int pictures = 0;
    };

    Simulation::Impl& impl_;
    Trace physics_, pictures_, stepTime_;
    Sums now_;
    Sums last_; ///< sums of the newest point, from which the numbers are computed
    double lastSeconds_ = 0.0;
    Nanoseconds since_ = 0;
    bool paused_ = false;
    double time_ = 0.0, guiSeconds_ = 0.0;
    std::uint64_t step_ = 0;
    std::uint64_t late_ = 0, clamped_ = 0, undone_ = 0, notConverged_ = 0,
                  outOfTime_ = 0;                 ///< steps since the panel was opened
    physics::Unrest unrest_;                      ///< in the last step
    std::uint64_t energyGained_ = 0;              ///< steps since the panel was opened
    int intersecting_ = 0, mostIntersecting_ = 0; ///< pairs of bodies that pass through each other, in the same way
    int beyondStrain_ = 0, mostBeyondStrain_ = 0; ///< elements beyond the range of their material, in the same way
    int inverted_ = 0, mostInverted_ = 0;         ///< elements inside out in the newest step, and at most since then
    std::vector<physics::BodySolve> solves_;
    physics::ContactReport contacts_;
};

} // namespace filasofia::runtime
