#pragma once

#include "filasofia/prefab/scope_hands.h"

#include <atomic>

namespace filasofia::prefab {

/// The outer end of the shaft, as a body that a haptic device holds. It has a mass, and by the law of the lever about
/// the fulcrum it feels the tissue's forces on scope and instrument.
class ScopeHandle {
public:
    ScopeHandle(runtime::Simulation& simulation, const ScopeHandsDef& def); ///< the def must have been checked

    [[nodiscard]] BodyId body() const { return body_; }
    /// The hands that correspond to the handle's pose. While its second button is pressed, it moves the instrument
    /// instead of the scope.
    [[nodiscard]] ScopeHand hand(const frame::Frame& now);
    /// Called on another thread than hand(); takes effect at the next step.
    void clutch(bool pressed) { clutched_ = pressed; }
    /// Applies the forces on the tools to the handle, until the next step.
    void feel(const frame::Frame& now, BodyId scope, BodyId instrument) const;

private:
    runtime::Simulation& simulation_;
    ScopeHandsDef def_;
    BodyId body_;
    std::atomic<bool> clutched_ = false;
    double depth_ = 0.0; ///< [m], depth of the handle in the previous step
    ScopeHand hand_;
};

} // namespace filasofia::prefab
