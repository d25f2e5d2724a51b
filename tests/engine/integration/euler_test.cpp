#include "filasofia/engine/integration/euler.h"

namespace euler_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

const std::vector<double> kMasses{2.0, 2.0};
const std::vector<bool> kFixed{false, true};
const RayleighDamping kDamping{.mass = 0.5, .stiffness = 0.1};

} // namespace

TEST_CASE("explicit Euler moves with the old velocity, symplectic Euler with the new one, and fixed nodes stay")
{
    const std::vector<Vec3> forces(2, {4, 0, 0}), stiffnessTimesVelocity(2, {0, 10, 0});
    for (bool symplectic : {false, true}) {
        std::vector<Vec3> x(2), v(2, {0, 0, 1}), dv(2, {9, 9, 9});
        v[1] = {};
        explicitChange(0.5, kDamping, 1.0, {kMasses, forces, stiffnessTimesVelocity, v, kFixed}, dv);
        move(0.5, !symplectic, dv, x, v);
        // (f - a M v - b K v) / m = (4, -1, -1) / 2
        CHECK(v[0] == Vec3{1.0, -0.25, 0.75});
        CHECK(x[0] == (symplectic ? 0.5 * v[0] : Vec3{0, 0, 0.5}));
        CHECK(v[1] == Vec3{});
        CHECK(x[1] == Vec3{});
    }
}

TEST_CASE("implicit Euler moves with the new velocity")
{
    const std::vector<Vec3> dv{{1, 0, 0}};
    std::vector<Vec3> x{{10, 0, 0}}, v{{2, 4, 0}};
    move(0.5, false, dv, x, v);
    CHECK(v[0] == Vec3{3, 4, 0});
    CHECK(x[0] == Vec3{11.5, 2, 0});
}

TEST_CASE("the weights and the right-hand side of the implicit step match the formula")
{
    const double h = 0.5;
    const ImplicitWeights w = implicitWeights(h, kDamping);
    CHECK(w.mass == 1.25);
    CHECK(w.stiffness == Approx(0.3));
    CHECK(w.damping == 0.5);
    const std::vector<Vec3> forces(2, {4, 0, 0}), stiffnessTimesVelocity(2, {0, 10, 0}), v{{0, 0, 1}, {}};
    std::vector<Vec3> b(2, {9, 9, 9});
    implicitRightHandSide(h, kDamping, {kMasses, forces, stiffnessTimesVelocity, v, kFixed}, b);
    CHECK(distance(b[0], {2.0, -0.3 * 10, -0.5}) < 1e-14); // h (f - a M v - b K v) - h^2 K v
    CHECK(b[1] == Vec3{});
}

} // namespace euler_test
