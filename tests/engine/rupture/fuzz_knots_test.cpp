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

TEST_CASE("threads among needles and jaws and around tissue pass through nothing, and the same again", "[cases]")
{
    const testing::KnotFuzzReport report = testing::fuzzKnots(
        {.seed = 1, .seconds = 6 * cases(2000) * 1e-3, .perScene = cases(2000) * 1e-3, .tools = true, .twice = true});
    CHECK(report.scenes == 6);
    REQUIRE(report.kinds.size() == 3);
    CHECK(report.kinds.back().name == "around tissue");
    if (cases(2000) == 2000) CHECK(report.linkingTests > 0); // a thread goes around tissue after a second or so
    CHECK(report.mostContacts > 5);
    CHECK(report.sound());
    for (const std::string& example : report.examples) WARN(example);
}

TEST_CASE("random scenes in which threads went through needles and a bar: they do not any more")
{
    // A thread that turns back meets a bar that moves by eight radii in a step; needles that are jerked about by what
    // they catch; a needle that is drawn against a thread with newtons, deeper and deeper.
    struct Scene {
        std::uint64_t seed;
        int first;
        double time; ///< [s] just after the first pass that there was
        bool tools = true;
    };
    for (const Scene& each :
         {Scene{41018, 22, 1.52, false}, {41056, 21, 0.81}, {41020, 0, 0.6}, {41020, 9, 0.66}, {41004, 0, 0.33}}) {
        const testing::KnotFuzzReport report = testing::fuzzKnots(
            {.seed = each.seed, .seconds = each.time, .perScene = each.time, .first = each.first, .tools = each.tools});
        CAPTURE(each.seed, each.first);
        CHECK(report.scenes == 1);
        CHECK(report.passes == 0);
        CHECK(report.notFinite == 0);
        for (const std::string& example : report.examples) WARN(example);
    }
}

TEST_CASE("random scenes in which a needle turned to and fro within a step and left its thread: it does not any more")
{
    for (const auto& [seed, first] : {std::pair{51004u, 18}, {41024u, 0}}) {
        const testing::KnotFuzzReport report =
            testing::fuzzKnots({.seed = seed, .seconds = 1.0, .perScene = 1.0, .first = first, .tools = true});
        CAPTURE(seed, first);
        CHECK(report.scenes == 1);
        CHECK(report.sound());
        for (const std::string& example : report.examples) WARN(example);
    }
}

TEST_CASE("random scenes in which a thread slipped on soft tissue and ended deep in it: it does not any more", "[long]")
{
    for (const auto& [seed, first] : {std::pair{81019u, 14}, {81040u, 8}}) {
        const testing::KnotFuzzReport report =
            testing::fuzzKnots({.seed = seed, .seconds = 1.85, .perScene = 1.85, .first = first, .tools = true});
        CAPTURE(seed, first);
        CHECK(report.scenes == 1);
        CHECK(report.insideTissue == 0);
        CHECK(report.deepest < 2.5); // [diameters]; it was 3.8 and 3.2
        CHECK(report.sound());
        for (const std::string& example : report.examples) WARN(example);
    }
}

} // namespace fuzz_knots_test
