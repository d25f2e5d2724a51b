#include "verification/bunny.h"

namespace solvers_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr ConjugateGradient kTight{.maxIterations = 10000, .tolerance = 1e-12, .assembled = true};

} // namespace

TEST_CASE("Cholesky and tight conjugate gradients agree")
{
    Stage direct = standingBunny(1492, Cholesky{}), iterative = standingBunny(1492, kTight);
    CHECK(direct.run(100, 0.005).flags == 0);
    CHECK(iterative.run(100, 0.005).flags == 0);
    verify("bunny 1492 after 100 steps, Cholesky against CG at 1e-12, relative to displacement",
           relativeDistance(direct.soft().x, iterative.soft().x, displacement(direct)), 1e-8);
}

TEST_CASE("the default tolerance of conjugate gradients is accurate to a thousandth")
{
    for (int elements : {756, 1492, 3004})
        for (double dt : {0.001, 0.005}) {
            Stage exact = standingBunny(elements, kTight), fast = standingBunny(elements, ConjugateGradient{});
            CHECK(exact.run(200, dt).flags == 0);
            CHECK(fast.run(200, dt).flags == 0);
            verify(text("bunny ", elements, " after 200 steps of ", dt * 1e3,
                        " ms, CG at its default tolerance against 1e-12, relative to displacement"),
                   relativeDistance(fast.soft().x, exact.soft().x, displacement(exact)), 1e-3);
        }
}

} // namespace solvers_test
