#pragma once

#include "filasofia/frame/frame.h"
#include "filasofia/metric/session.h"

namespace filasofia::metric {

/// Which point of a body is followed.
struct Observed {
    BodyId body = {};
    int element = 0;   ///< [-], >= 0, of a rigid body
    Vec3 tip = {};     ///< [m], in the element's coordinates; a soft body's point is the mean of its nodes
    bool force = true; ///< the contacts too
};

/// The sample that a frame holds of it; all NaN where the body is not there.
Sample sampleOf(const frame::Frame& frame, const Observed& observed);

} // namespace filasofia::metric
