#pragma once

#include "filasofia/runtime/simulation_impl.h"

namespace filasofia::runtime {

/// The origin of the device's axes that puts a hand at `hand` (in device coordinates) at `place` in the scene. The axes
/// keep their directions.
Pose originThrough(Vec3 place, Vec3 hand, double scale, Quat orientation);

/// The inspector's part about haptic interfaces: where each hand is, which force it feels and how evenly its servo
/// ticks. It also moves the device's place in the scene while somebody holds it.
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
