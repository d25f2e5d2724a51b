#include "engine/stage.h"

namespace recovery_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

/// Steps a bunny from the positions that `place` sets until no element is inverted. Returns the number of steps, at
/// maxSteps `maxSteps`.
template <class Place>
int stepsToRecover(Place place, int maxSteps, Rayleigh damping = {}, ConjugateGradient solver = {})
{
    Stage stage;
    SoftBodyDef def{.mesh = bunnyFile(756), .rayleigh = damping, .gravity = false, .solver = solver};
    stage.add(def);
    stage.step(0.0);
    place(stage.soft().x);
    for (int i = 1; i <= maxSteps; ++i) {
        if (stage.step(0.01).has(StepFlag::Undone)) return maxSteps;
        if (invertedElements(stage.model(), stage.soft()) == 0) return i;
    }
    return maxSteps;
}

} // namespace

TEST_CASE("a bunny turned inside out recovers")
{
    CHECK(stepsToRecover(
              [](std::vector<Vec3>& x) {
                  for (Vec3& p : x) p.x = -p.x;
              },
              1000) < 1000);
}

TEST_CASE("a bunny flattened to a sheet recovers")
{
    CHECK(stepsToRecover(
              [](std::vector<Vec3>& x) {
                  for (Vec3& p : x) p.y = 0.05;
              },
              1000) < 1000);
}

TEST_CASE("a bunny shrunk to a point recovers")
{
    CHECK(stepsToRecover(
              [](std::vector<Vec3>& x) {
                  for (Vec3& p : x) p = {0, 0.1, 0};
              },
              1000) < 1000);
}

TEST_CASE("a bunny with every node moved by up to several elements recovers")
{
    for (unsigned seed : {1u, 2u, 3u}) {
        std::mt19937 random(seed);
        const auto scramble = [&](std::vector<Vec3>& x) {
            for (Vec3& p : x) p += randomVec3(random, 0.03);
        };
        CHECK(stepsToRecover(scramble, 1000) < 1000);
    }
}

// Without lameAt()'s rule some of these settle in a knot: an equilibrium with two to five inverted elements.
TEST_CASE("a bunny with every node anywhere in its box recovers")
{
    for (const Rayleigh& damping : {Rayleigh{}, Rayleigh{0.0, 0.0}})
        for (unsigned seed = 1; seed <= 8; ++seed) {
            std::mt19937 random(seed);
            const auto scramble = [&](std::vector<Vec3>& x) {
                for (Vec3& p : x) p = randomVec3(random, 0.08);
            };
            CHECK(stepsToRecover(scramble, 1000, damping) < 1000);
        }
}

TEST_CASE("a bunny with every node anywhere in its box recovers in double precision too")
{
    for (unsigned seed : {1u, 2u, 3u}) {
        std::mt19937 random(seed);
        const auto scramble = [&](std::vector<Vec3>& x) {
            for (Vec3& p : x) p = randomVec3(random, 0.08);
        };
        CHECK(stepsToRecover(scramble, 1000, {}, {.tolerance = 1e-4, .assembled = true}) < 1000);
    }
}

} // namespace recovery_test
