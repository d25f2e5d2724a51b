#pragma once

#include "filasofia/frame/frame.h"
#include "filasofia/metric/session.h"

namespace filasofia::metric {

/// The observed point of a body.
struct Observed {
    BodyId body = {};
    int element = 0;   ///< [-], >= 0, element of a rigid body
    Vec3 tip = {};     ///< [m], in the element's coordinates; for a soft body the point is the mean of its nodes
    bool force = true; ///< whether to sample contacts and attachments to other bodies
};

/// The sample of the point in a frame; all NaN if the body is not there.
Sample sampleOf(const frame::Frame& frame, const Observed& observed);

/// Samples a body less often than physics steps without missing a short force peak: a sample's force is the mean over
/// the steps since the previous sample, so that impulses are exact. Its number of contacts is the largest of these
/// steps, and its point is that of the strongest force.
class StepSampler {
public:
    explicit StepSampler(const Observed& observed) : observed_(observed) {}
    /// To be called after every step of `dt` [s]; 0 if unknown.
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
