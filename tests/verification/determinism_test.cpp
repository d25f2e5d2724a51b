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
