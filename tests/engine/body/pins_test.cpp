#include "filasofia/engine/body/pins.h"

namespace pins_test {

using namespace filasofia;
using namespace filasofia::engine;

TEST_CASE("a pin spring pulls its node towards its anchor")
{
    const Pins pins{.hard = {false, false}, .springs = {{.node = 1, .anchor = {1, 0, 0}, .stiffness = 4}}};
    const std::vector<Vec3> x{{5, 5, 5}, {1, 0.5, 0}};
    std::vector<Vec3> forces{{1, 1, 1}, {0, 0, 2}};
    addPinForces(pins, x, forces);
    CHECK(forces[0] == Vec3{1, 1, 1});
    CHECK(forces[1] == Vec3{0, -2, 2});
}

TEST_CASE("several pin springs on one node add up")
{
    const Pins pins{.hard = {false}, .springs = {{0, {1, 0, 0}, 4}, {0, {-1, 0, 0}, 1}}};
    const std::vector<Vec3> x{{0, 0, 0}};
    std::vector<Vec3> forces(1);
    addPinForces(pins, x, forces);
    CHECK(forces[0] == Vec3{3, 0, 0});
}

} // namespace pins_test
