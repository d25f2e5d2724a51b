#pragma once

#include "filasofia/prefab/scope_hands.h"

#include <atomic>

namespace filasofia::prefab {

/// The outer end of the shaft, as a body that a haptic device holds: it weighs something, and feels by the laws of the
/// lever about the fulcrum what tissue does to scope and instrument.
class ScopeHandle {
public:
    ScopeHandle(runtime::Simulation& simulation, const ScopeHandsDef& def); ///< a def that was checked

    [[nodiscard]] BodyId body() const { return body_; }
    /// The hands that hold it like that. Its second button held, it moves the instrument in place of the scope.
    [[nodiscard]] ScopeHand hand(const frame::Frame& now);
    /// Told on another thread than hand(): from the next step on.
    void clutch(bool pressed) { clutched_ = pressed; }
    /// Pushes it, until the next step, as the tools are pushed.
    void feel(const frame::Frame& now, BodyId scope, BodyId instrument) const;

private:
    runtime::Simulation& simulation_;
    ScopeHandsDef def_;
    BodyId body_;
    std::atomic<bool> clutched_ = false;
    double depth_ = 0.0; ///< [m], of the handle, in the step before
    ScopeHand hand_;
};

} // namespace filasofia::prefab
