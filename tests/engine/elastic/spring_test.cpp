#include "filasofia/engine/elastic/spring.h"

#include "engine/meshes.h"

namespace spring_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

const Spring kSpring{.nodes = {0, 1}, .restLength = 2.0, .stiffness = 5.0, .damping = 3.0};

} // namespace

TEST_CASE("a stretched spring pulls its ends together, a compressed one pushes them apart")
{
    CHECK(springForce(kSpring, {0, 0, 0}, {3, 0, 0}) == Vec3{5, 0, 0});
    CHECK(springForce(kSpring, {0, 0, 0}, {0, 1, 0}) == Vec3{0, -5, 0});
    CHECK(springForce(kSpring, {0, 0, 0}, {0, 0, 2}) == Vec3{});
    CHECK(springEnergy(kSpring, {0, 0, 0}, {3, 0, 0}) == 2.5);
}

TEST_CASE("a dashpot resists only the motion along the spring")
{
    CHECK(dashpotForce(kSpring, {0, 0, 0}, {1, 0, 0}, {}, {2, 7, 0}) == Vec3{6, 0, 0});
    CHECK(dashpotForce(kSpring, {0, 0, 0}, {1, 0, 0}, {4, 0, 0}, {4, 0, 1}) == Vec3{});
    const Mat3 d = springDamping(kSpring, {0, 0, 0}, {1, 0, 0});
    CHECK(d == 3.0 * outer({1, 0, 0}, {1, 0, 0}));
}

TEST_CASE("a spring with coincident ends has no force and never a NaN")
{
    const Vec3 p{1, 2, 3};
    CHECK(springForce(kSpring, p, p) == Vec3{});
    CHECK(dashpotForce(kSpring, p, p, {1, 0, 0}, {}) == Vec3{});
    CHECK(springStiffness(kSpring, p, p) == Mat3{});
    CHECK(springDamping(kSpring, p, p) == Mat3{});
    CHECK(springEnergy(kSpring, p, p) == 10.0);
}

TEST_CASE("a spring's stiffness is positive semi-definite in extension and in compression")
{
    std::mt19937 random(4);
    for (int k = 0; k < 300; ++k) {
        const Vec3 b = randomVec3(random, 3.0);
        const Mat3 stiffness = springStiffness(kSpring, {}, b);
        CHECK(frobeniusNorm(stiffness - transpose(stiffness)) == 0.0);
        for (int j = 0; j < 20; ++j) {
            const Vec3 u = randomVec3(random, 1.0);
            CHECK(dot(u, stiffness * u) >= -1e-13);
        }
        CHECK(dot(b, stiffness * b) == Approx(5.0 * dot(b, b))); // always Hooke's stiffness along the spring
    }
}

} // namespace spring_test
