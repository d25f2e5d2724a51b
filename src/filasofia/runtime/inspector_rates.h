#pragma once

#include "filasofia/runtime/simulation_impl.h"

#include <array>
#include <map>

namespace filasofia::runtime {

/// The last numbers of something, for a plot.
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
    [[nodiscard]] int oldest() const { return count_ < kLength ? 0 : next_; } ///< where in data() it begins
    [[nodiscard]] int count() const { return count_; }

private:
    std::array<float, kLength> values_ = {};
    int next_ = 0;
    int count_ = 0;
};

/// How fast both servers go, where a step's time goes, and how its solvers do.
class InspectorRates {
public:
    explicit InspectorRates(Simulation::Impl& impl) : impl_(impl) {}

    /// Forgets the time in which nobody looked.
    void restart();
    void add(const physics::StepReport& report);
    /// A picture was drawn; a tenth of a second at a time becomes one point of the plots.
    void addPicture(double guiSeconds);
    void draw();

    [[nodiscard]] bool paused() const { return paused_; }
    [[nodiscard]] double physicsRate() const { return physics_.newest(); }
    /// The picture was drawn: the driver leaves some out.
    void countDrawn() { ++now_.pictures; }
    [[nodiscard]] double pictureRate() const { return pictures_.newest(); }

private:
    void drawStages() const;
    void drawSolvers() const;
    [[nodiscard]] std::string nameOf(BodyId id) const;

    /// Of the steps since the last point.
    struct Sums {
        int steps = 0;
        int moving = 0; ///< not paused
        double simulated = 0.0;
        physics::StageTimes times;
        int pictures = 0;
    };

    Simulation::Impl& impl_;
    Trace physics_, pictures_, stepTime_;
    Sums now_;
    Sums last_; ///< of the newest point: what the numbers are about
    double lastSeconds_ = 0.0;
    Nanoseconds since_ = 0;
    bool paused_ = false;
    double time_ = 0.0, guiSeconds_ = 0.0;
    std::uint64_t step_ = 0;
    std::uint64_t late_ = 0, clamped_ = 0, undone_ = 0, notConverged_ = 0, outOfTime_ = 0; ///< since it was opened
    std::vector<physics::BodySolve> solves_;
    physics::ContactReport contacts_;
};

} // namespace filasofia::runtime
