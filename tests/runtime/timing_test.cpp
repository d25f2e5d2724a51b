#include "filasofia/runtime/timing.h"

namespace timing_test {

using namespace filasofia::runtime;

TEST_CASE("percentiles are by nearest rank")
{
    std::vector<double> values;
    for (int i = 100; i >= 1; --i) values.push_back(i);
    const Spread spread = spreadOf(values);
    CHECK(spread.median == 50);
    CHECK(spread.p1 == 1);
    CHECK(spread.p99 == 99);
    CHECK(spreadOf({7}).p99 == 7);
    CHECK(spreadOf({}).median == 0);
}

TEST_CASE("the rate is one over the time between wake-ups")
{
    RunTiming timing;
    for (int i = 0; i < 5; ++i)
        timing.steps.push_back({.wake = i * 5'000'000, .dt = 5'000'000, .cost = 1'000'000 * (i + 1)});
    CHECK(timing.rate().median == Approx(200.0));
    CHECK(timing.cost().median == Approx(3e-3));
    timing.wallSeconds = 2.0;
    timing.simulatedSeconds = 1.0;
    CHECK(timing.realTimeFactor() == 0.5);
}

} // namespace timing_test
