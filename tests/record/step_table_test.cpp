#include "filasofia/record/step_table.h"

#include "filasofia/core/error.h"
#include "record/runs.h"

namespace step_table_test {

using namespace filasofia;

TEST_CASE("the step table has a line per step")
{
    const record::ScratchFile file("table.csv");
    {
        record::StepTable table(file.path());
        physics::StepRecord step;
        step.report = {.step = 7, .time = 0.5, .dt = 1e-3, .flags = 4};
        const BodyId one{1}, two{2}, three{3}; // two and three were solved together
        step.report.solves = {{one, 12, 0.0, one}, {two, 30, 0.0, two}, {three, 30, 0.0, two}};
        step.report.contacts = {.found = 3, .active = 2, .penetration = 1e-4};
        step.contacts = {{.normalForce = 0.5}, {.normalForce = 0.25}, {}};
        step.report.times = {.commands = 1e-6, .contacts = 3e-5, .assemble = 2e-4, .advance = 5e-4, .topology = 4e-5};
        step.report.topology.ruptures = {{.area = 1e-5}, {.area = 2e-5}};
        step.report.breaks = {{.points = 4}, {.points = 1, .broken = true}};
        step.hash = 0xabc;
        table.write(step);
    }
    const auto lines = file.lines();
    REQUIRE(lines.size() == 2);
    CHECK(lines[0] == "step,time [s],dt [s],flags,iterations,hash,contacts,contact force [N],penetration [m],"
                      "opened [m^2],let go,commands [s],contacts [s],assemble [s],advance [s],topology [s]");
    CHECK(lines[1] == "7,0.5,0.001,4,42,0000000000000abc,2,0.75,0.0001,3e-05,5,1e-06,3e-05,0.0002,0.0005,4e-05");
}

TEST_CASE("a step table says when it cannot be written")
{
    CHECK_THROWS_WITH(record::StepTable("/no/such/folder/log.csv"), "/no/such/folder/log.csv: cannot be written");
    record::StepTable full("/dev/full");
    CHECK_THROWS_WITH(full.flush(), "/dev/full: cannot be written (disk full?)");
    CHECK_THROWS_WITH(record::StepTable("/dev/full").close(), "/dev/full: cannot be written (disk full?)");
}

} // namespace step_table_test
