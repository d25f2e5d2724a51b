#pragma once

#include "filasofia/visual/visual_server.h"

#include <functional>

namespace filasofia::visual {

/// Sums the times of stages; without a clock it does nothing.
class StageWatch {
public:
    StageWatch() = default;
    explicit StageWatch(std::function<double()> now) : now_(std::move(now)) {}

    void start()
    {
        if (now_) last_ = now_();
    }
    /// Adds the time since start() or the last lap to this stage.
    void lap(double VisualStages::*stage)
    {
        if (!now_) return;
        const double now = now_();
        sums_.*stage += now - last_;
        last_ = now;
    }
    [[nodiscard]] const VisualStages& sums() const { return sums_; }

private:
    std::function<double()> now_;
    double last_ = 0.0;
    VisualStages sums_;
};

} // namespace filasofia::visual
