#pragma once

#include "filasofia/core/published.h"
#include "filasofia/prefab/endoscope.h"

#include <mutex>
#include <tuple>

namespace filasofia::prefab {

/// Fog and smears on the lens of a scope: what becomes of them from step to step, and how they are drawn.
class LensSoiling {
public:
    LensSoiling(runtime::Simulation& simulation, BodyId scope, int camera, const std::optional<LensDef>& def);

    /// Any thread.
    void set(const LensState& lens);
    [[nodiscard]] LensState now() const { return newest_.read(); }
    /// The stepping thread, before the step that ends at `time` [s].
    void step(double time);
    /// The main thread, before every picture: as dirty as the lens, but no cleaner than its optics were made.
    void draw(visual::View& view, const visual::EndoscopeOptics& made) const;

    struct State {
        LensState lens = {};
        double last = 0.0;      ///< [s]
        double lookFrom = 0.0;  ///< [s], no look at the smoke before
        double thickness = 0.0; ///< [1/m], optical depth per length of the smoke before the lens
    };
    using Kept = std::tuple<State>;
    auto kept() { return std::tie(state_); }
    void publish() { newest_.write(state_.lens); }

private:
    [[nodiscard]] bool touches(const frame::Frame& frame, const Pose& camera) const;
    [[nodiscard]] double smokeBefore(const Pose& camera) const;

    runtime::Simulation& simulation_;
    const BodyId scope_;
    const int camera_;
    const std::optional<LensDef> def_;
    State state_; ///< the stepping thread's
    std::mutex mutex_;
    std::optional<LensState> asked_; ///< guarded by mutex_
    Published<LensState> newest_;    ///< for all threads
};

} // namespace filasofia::prefab
