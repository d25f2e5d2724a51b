#include "verification/bunny.h"

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

TEST_CASE("two runs of every bunny have the same hash at every step")
{
    for (int elements : {756, 1492, 3004}) {
        Stage a = standingBunny(elements, ConjugateGradient{}), b = standingBunny(elements, ConjugateGradient{});
        for (int i = 0; i < 50; ++i) {
            a.step(0.005);
            b.step(0.005);
            REQUIRE(a.world.hash() == b.world.hash());
        }
        std::cout << "verification: bunny " << elements << " after 50 steps, hash: " << std::hex << a.world.hash()
                  << std::dec << " (bound: two runs equal)\n";
    }
}

// No contraction, no -ffast-math, fixed order of sums: every compiler on every x86-64 machine computes these bits.
// Whoever changes the engine's arithmetic or what a hash is made of copies the new ones from what this test prints:
//   test_verification "after 50 steps*"      (and says so in CHANGELOG.md: recorded hashes change for users too)
TEST_CASE("after 50 steps of 1 ms every bunny has the hash that it had on any machine")
{
    const std::pair<int, std::uint64_t> goldens[] = {
        {756, 0xc4a79457c94ddf63}, {1492, 0x241e0ef1b6982ec8}, {3004, 0xd068708e14c6de10}};
    for (const auto& [elements, golden] : goldens) {
        Stage stage = standingBunny(elements, ConjugateGradient{});
        stage.run(50, 0.001);
        std::cout << "verification: bunny " << elements << " after 50 steps of 1 ms, hash: 0x" << std::hex
                  << stage.world.hash() << " (bound 0x" << golden << std::dec << ")\n";
        CHECK(stage.world.hash() == golden);
    }
}
