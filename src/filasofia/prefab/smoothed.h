#pragma once

#include <algorithm>
#include <cmath>

namespace filasofia::prefab {

/// Exponential moving average: contact forces jump from step to step, their average does not.
class Smoothed {
public:
    explicit Smoothed(double seconds) : seconds_(seconds) {}
    /// Returns the average after `value` has lasted until `time` [s].
    double follow(double time, double value)
    {
        const double passed = std::max(0.0, time - time_);
        time_ = time;
        return mean_ += (1.0 - std::exp(-passed / seconds_)) * (value - mean_);
    }

private:
    double seconds_;
    double time_ = 0.0;
    double mean_ = 0.0;
};

} // namespace filasofia::prefab
