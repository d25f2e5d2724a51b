#pragma once

#include "filasofia/core/body_id.h"

namespace filasofia::frame {

/// A cavity of a soft body, after a step.
struct Cavity {
    BodyId body = {};
    int cavity = 0;        ///< index in SoftBodyDef::cavities
    double volume = 0.0;   ///< [m^3]; if it is open, up to a flat lid on each opening
    double pressure = 0.0; ///< [Pa], above that outside
    bool open = false;     ///< a cut or a tear has joined it to the outside
    double opening = 0.0;  ///< [m^2] area of all its openings: 0 while their lips lie on each other
    double outflow = 0.0;  ///< [m^3/s] through the openings, at its pressure; negative: inwards
    double lost = 0.0;     ///< [m^3] all that has flowed out through openings since the start, at the outer pressure
};

} // namespace filasofia::frame
