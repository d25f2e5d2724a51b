#include "filasofia/testing/fuzz_knots.h"

#include "effort.h"

namespace fuzz_knots_test {

using namespace filasofia;

TEST_CASE("threads that are tied and pulled at random pass through nothing, and the same again", "[cases]")
{
    // One scene of each kind.
    const testing::KnotFuzzReport report =
        testing::fuzzKnots({.seed = 3, .seconds = 6 * cases(300) * 1e-3, .perScene = cases(300) * 1e-3, .twice = true});
    CHECK(report.scenes == 6);
    CHECK(report.passes == 0);
    CHECK(report.linkingChanges == 0);
    CHECK(report.insideTissue == 0);
    CHECK(report.notFinite == 0);
    CHECK(report.undone == 0);
    CHECK(report.hashesThatDiffer == 0);
    CHECK(report.mostContacts > 10);
    for (const std::string& example : report.examples) WARN(example);
}

} // namespace fuzz_knots_test
