#pragma once

#include "filasofia/runtime/parts.h"

namespace filasofia::runtime {

/// Of the device's axes, such that a hand at `hand` along them is at `place` in the scene; they keep their directions.
Pose originThrough(Vec3 place, Vec3 hand, double scale, Quat orientation);

/// The inspector's part about haptic interfaces: where each hand is, what it feels and how evenly its servo ticks; and
/// where the device is in the scene, to be changed while it is held.
class InspectorHands {
public:
    explicit InspectorHands(Simulation::Impl& parts) : parts_(parts) {}

    [[nodiscard]] bool any() const { return !parts_.haptics.ids().empty(); }
    void draw();

private:
    void drawHand(HapticId id);
    void drawJitter(const device::ServoStatistics& servo) const;
    void drawPlace(HapticId id, const HapticState& state);
    void place(HapticId id, double scale, const Pose& origin);

    Simulation::Impl& parts_;
    std::string problem_;
};

} // namespace filasofia::runtime
