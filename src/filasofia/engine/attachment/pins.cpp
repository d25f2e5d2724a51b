#include "filasofia/engine/attachment/pins.h"

namespace filasofia::engine {

void addPinForces(const Pins& pins, std::span<const Vec3> x, std::span<Vec3> forces)
{
    for (const PinSpring& pin : pins.springs) forces[pin.node] += pin.stiffness * (pin.anchor - x[pin.node]);
}

} // namespace filasofia::engine
