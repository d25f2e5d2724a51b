#pragma once

#include "apps/hysteroscopy/patient.h"

namespace hysteroscopy {

/// The fluid that holds the cavity open, what bleeds into it, and the keys of its pump and taps: I opens and closes the
/// inflow, O the outflow, U and J change the pressure by 10 mmHg.
class Fluid {
public:
    /// Construct it before a run. `pressure` [Pa]: at the start. `flux` [m/s] is that of the polyp or the myoma where
    /// it is opened.
    Fluid(filasofia::Simulation& sim, const Bodies& bodies, double pressure, double flux);

    /// The wall was pierced here, and bleeds.
    void pierced(filasofia::Vec3 place);
    void outflow(bool open); ///< wide, or as a trickle that keeps the view clear
    [[nodiscard]] filasofia::DistensionBalance balance() const { return sim_.distension(); }
    [[nodiscard]] double bloodLost() const; ///< [m^3]

private:
    void press(const filasofia::KeyEvent& key);

    filasofia::Simulation& sim_;
    const Bodies bodies_;
    double pressure_; ///< [Pa]
    bool in_ = true;
    bool out_ = false;
    const filasofia::FluidPanel panel_;
};

} // namespace hysteroscopy
