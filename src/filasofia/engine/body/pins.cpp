#include "filasofia/engine/body/pins.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::engine {

void releaseGroup(std::size_t group, Pins& pins)
{
    const PinGroup gone = std::move(pins.groups[group]);
    pins.groups.erase(pins.groups.begin() + static_cast<std::ptrdiff_t>(group));
    const auto holdsHard = [](const PinGroup& each, int node) {
        return std::isinf(each.stiffness) && std::binary_search(each.nodes.begin(), each.nodes.end(), node);
    };
    for (int node : gone.nodes) {
        if (std::isinf(gone.stiffness)) {
            pins.hard[node] = std::ranges::any_of(pins.groups, [&](const auto& each) { return holdsHard(each, node); });
        } else if (const auto spring = std::ranges::find_if(
                       pins.springs,
                       [&](const PinSpring& each) { return each.node == node && each.stiffness == gone.stiffness; });
                   spring != pins.springs.end()) {
            pins.springs.erase(spring);
        }
    }
}

void addPinForces(const Pins& pins, std::span<const Vec3> x, std::span<Vec3> forces)
{
    for (const PinSpring& pin : pins.springs) forces[pin.node] += pin.stiffness * (pin.anchor - x[pin.node]);
}

} // namespace filasofia::engine
