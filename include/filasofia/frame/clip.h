#pragma once

#include "filasofia/core/attachment_id.h"
#include "filasofia/core/body_id.h"
#include "filasofia/math/vec3.h"

namespace filasofia::frame {

/// A clip on tissue, after a step.
struct Clip {
    AttachmentId id = {};
    BodyId clip = {};     ///< the rigid body
    BodyId tissue = {};   ///< the soft body
    Vec3 place = {};      ///< [m] the middle of the tissue between its legs
    double gap = 0.0;     ///< [m] between its legs, without what they give by their stiffness
    double force = 0.0;   ///< [N] with which its legs press
    bool closed = false;  ///< the applier has done its work
    bool partial = false; ///< tissue went on beyond its legs when it was applied: it does not close all of it
};

} // namespace filasofia::frame
