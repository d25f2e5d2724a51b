#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/math/vec3.h"

namespace filasofia::frame {

/// A channel that a needle has pierced into tissue, after a step.
struct Channel {
    BodyId tissue = {};
    BodyId needle = {};    ///< the body in front: the needle that pierced it, or a thread that was released from it
    BodyId inside = {};    ///< the body at its entry: the needle, or a thread that follows it
    Vec3 entry = {};       ///< [m] where the needle went in
    Vec3 end = {};         ///< [m] the deepest place, or where it came out
    double length = 0.0;   ///< [m] length of needle and thread in the tissue
    bool through = false;  ///< the tip came out again
    Vec3 force = {};       ///< [N] on the tissue, of tip and shaft together
    double friction = 0.0; ///< [N] on the tissue along the lines, towards the tip: the sum over the shaft
    double tip = 0.0;      ///< [N] with which the tip pushes the tissue, along the needle
};

} // namespace filasofia::frame
