#include "filasofia/runtime/run_counters.h"

#include <catch2/catch.hpp>

namespace run_counters_test {

using namespace filasofia;
using physics::Rupture;
using physics::StepFlag;

TEST_CASE("counters tell of each body what was cut and torn, and count a step with both once")
{
    runtime::RunCounters counters;
    counters.begin();
    const auto step = [&](const std::vector<Rupture>& ruptures) {
        physics::StepReport report;
        report.topology.ruptures = ruptures;
        counters.count(report);
    };
    const auto rupture = [](std::uint32_t body, Rupture::Kind kind, double area) {
        return Rupture{.kind = kind, .body = BodyId{body}, .area = area};
    };
    Rupture off = rupture(2, Rupture::Kind::Tear, 4e-6);
    off.detached.resize(3);
    off.cavities = {0};
    step({rupture(1, Rupture::Kind::Cut, 1e-6), rupture(2, Rupture::Kind::Cut, 2e-6), off});
    step({rupture(2, Rupture::Kind::Cut, 8e-6)});
    step({});

    REQUIRE(counters.opened().size() == 2);
    const runtime::OpenedSurfaces &first = counters.opened().at(BodyId{1}), &second = counters.opened().at(BodyId{2});
    CHECK(first.steps == 1);
    CHECK(first.cut == 1e-6);
    CHECK(first.torn == 0.0);
    CHECK(second.steps == 2);
    CHECK(second.cut == Approx(10e-6));
    CHECK(second.torn == 4e-6);
    CHECK(second.pieces == 3);
    CHECK(second.cavities == 1);
    counters.begin();
    CHECK(counters.opened().empty());
}

TEST_CASE("counters count the steps in which a change of tissue found nothing")
{
    runtime::RunCounters counters;
    counters.begin();
    for (const bool found : {true, false, false}) {
        physics::StepReport report;
        if (!found) report.set(StepFlag::NothingChanged);
        counters.count(report);
    }
    runtime::RunReport report;
    counters.fill(report);
    CHECK(report.nothingChanged == 2);
}

} // namespace run_counters_test
