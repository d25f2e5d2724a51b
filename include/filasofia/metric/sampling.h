#pragma once

#include "filasofia/frame/frame.h"
#include "filasofia/metric/session.h"

namespace filasofia::metric {

/// Which point of a body is followed.
struct Observed {
    BodyId body = {};
    int element = 0;   ///< [-], >= 0, of a rigid body
    Vec3 tip = {};     ///< [m], in the element's coordinates; a soft body's point is the mean of its nodes
    bool force = true; ///< contacts and attachments to other bodies too
};

/// The sample that a frame holds of it; all NaN where the body is not there.
Sample sampleOf(const frame::Frame& frame, const Observed& observed);

/// Samples a body less often than physics steps, and misses no blow in between: a sample's force is the mean over the
/// steps since the sample before, so that impulses are exact; its contacts are the most, its point the strongest's.
class StepSampler {
public:
    explicit StepSampler(const Observed& observed) : observed_(observed) {}
    /// After every step of `dt` [s]; 0: not known.
    void add(const frame::Frame& frame, double dt);
    /// The sample at the newest step.
    Sample take();

private:
    Observed observed_;
    Sample newest_ = {};
    Vec3 impulse_ = {};      ///< [N s]
    double time_ = 0.0;      ///< [s]
    double strongest_ = 0.0; ///< [N]
    Vec3 point_ = {};
    int contacts_ = 0;
};

} // namespace filasofia::metric
