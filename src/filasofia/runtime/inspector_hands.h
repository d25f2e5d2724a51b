#pragma once

#include "filasofia/runtime/simulation_impl.h"

namespace filasofia::runtime {

/// Of the device's axes, such that a hand at `hand` along them is at `place` in the scene; they keep their directions.
Pose originThrough(Vec3 place, Vec3 hand, double scale, Quat orientation);

/// The inspector's part about haptic interfaces: where each hand is, what it feels and how evenly its servo ticks; and
/// where the device is in the scene, to be changed while it is held.
class InspectorHands {
public:
    explicit InspectorHands(Simulation::Impl& impl) : impl_(impl) {}

    [[nodiscard]] bool any() const { return !impl_.haptics.ids().empty(); }
    void draw();

private:
    void drawHand(HapticId id);
    void drawJitter(const device::ServoStatistics& servo) const;
    void drawPlace(HapticId id, const HapticState& state);
    void place(HapticId id, double scale, const Pose& origin);

    Simulation::Impl& impl_;
    std::string problem_;
};

} // namespace filasofia::runtime
