#include "verification/bunny.h"

namespace convergence_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

TEST_CASE("implicit Euler has first order in dt")
{
    const auto after = [](double dt) {
        Stage stage = standingBunny(756, Cholesky{});
        CHECK(stage.run(static_cast<int>(std::lround(0.05 / dt)), dt).flags == 0);
        return stage;
    };
    Stage reference = after(0.05 / 2400);
    const double size = displacement(reference);
    std::vector<double> errors;
    for (int steps : {50, 100}) {
        Stage stage = after(0.05 / steps);
        errors.push_back(relativeDistance(stage.soft().x, reference.soft().x, size));
        tell(text("bunny 756 after 0.05 s in ", steps, " steps, error relative to displacement"), errors.back());
    }
    // The reference has the same order: its own error moves the ratio from 2 to (1/50 - 1/2400) / (1/100 - 1/2400).
    verifyWithin("bunny 756, implicit Euler, ratio of errors at dt and dt / 2", errors[0] / errors[1], 1.8, 2.2);
}

TEST_CASE("every law: implicit Euler has first order in dt")
{
    for (const NamedLaw& each : everyLaw()) {
        const auto after = [&](int steps) { // the default solver: its error is far below that of the steps
            Stage stage = standingBunny(756, ConjugateGradient{.tolerance = 1e-6}, 1, each.law);
            CHECK(stage.run(steps, 0.05 / steps).flags == 0);
            return stage;
        };
        Stage reference = after(1200);
        std::vector<double> errors;
        for (const int steps : {50, 100}) {
            Stage stage = after(steps);
            errors.push_back(relativeDistance(stage.soft().x, reference.soft().x, displacement(reference)));
        }
        // As above, the error of the reference moves the ratio from 2 to 2.09.
        verifyWithin(text("bunny 756, ", each.name, ", implicit Euler, ratio of errors at dt and dt / 2"),
                     errors[0] / errors[1], 1.85, 2.25);
    }
}

} // namespace convergence_test
