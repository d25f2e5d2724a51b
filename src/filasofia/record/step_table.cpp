#include "filasofia/record/step_table.h"

#include "filasofia/core/output_file.h"

#include <array>
#include <cinttypes>

namespace filasofia::record {

struct StepTable::Impl {
    OutputFile file;
};

StepTable::StepTable(const std::filesystem::path& file) : impl_(new Impl{OutputFile(file)})
{
    impl_->file.write("step,time [s],dt [s],flags,iterations,hash,contacts,contact force [N],penetration [m],"
                      "opened [m^2],let go,commands [s],contacts [s],assemble [s],advance [s],topology [s]\n");
}

StepTable::~StepTable() = default;

void StepTable::write(const physics::StepRecord& step)
{
    const physics::StepReport& report = step.report;
    double force = 0.0; // sum over all contacts of the normal forces
    for (const frame::Contact& contact : step.contacts) force += contact.normalForce;
    double opened = 0.0; // by cuts and tears
    for (const physics::Rupture& rupture : report.topology.ruptures) opened += rupture.area;
    int letGo = 0; // points of attachments and grasps
    for (const physics::AttachmentBreak& each : report.breaks) letGo += each.points;
    std::array<char, 500> line; // sixteen numbers of at most 25 characters
    const int length = std::snprintf(
        line.data(), line.size(),
        "%" PRIu64 ",%.17g,%.17g,%" PRIu32 ",%d,%016" PRIx64 ",%d,%.9g,%.9g,%.9g,%d,%.9g,%.9g,%.9g,%.9g,%.9g\n",
        report.step, report.time, report.dt, report.flags, report.iterations(), step.hash, report.contacts.active,
        force, report.contacts.penetration, opened, letGo, report.times.commands, report.times.contacts,
        report.times.assemble, report.times.advance, report.times.topology);
    impl_->file.write({line.data(), static_cast<std::size_t>(length)});
}

void StepTable::flush() { impl_->file.flush(); }
void StepTable::close() { impl_->file.close(); }

} // namespace filasofia::record
