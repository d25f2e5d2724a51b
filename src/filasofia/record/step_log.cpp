#include "filasofia/record/step_log.h"

#include "filasofia/core/error.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/physics/physics_server.h"

#include <algorithm>
#include <cinttypes>
#include <cstdio>

namespace filasofia::record {
namespace {

using physics::Command;
using physics::StepFlag;
using physics::StepRecord;

bool repeatable(const StepRecord& step)
{
    return !step.report.has(StepFlag::Tuned) && !step.report.has(StepFlag::RecordLost);
}

/// A recorded command, ready to be applied again: bodies are built anew from their Defs.
struct Again {
    const physics::PhysicsEngine& engine;

    Command operator()(const physics::AddBody& add) const
    {
        return physics::AddBody{add.id, add.def, engine.build(*add.def)};
    }
    Command operator()(const physics::Tune&) const
    {
        fail("a recording with tune() cannot be made again from there on");
    }
    template <class Plain> Command operator()(const Plain& command) const { return command; }
};

} // namespace

void StepLog::drain(physics::PhysicsServer& server)
{
    while (physics::StepRecord* record = server.nextRecord()) {
        steps_.push_back(std::move(*record));
        server.popRecord();
    }
}

bool StepLog::replayable() const { return std::all_of(steps_.begin(), steps_.end(), repeatable); }

struct StepTable::Impl {
    std::string name;
    std::FILE* file = nullptr;
};

StepTable::StepTable(const std::filesystem::path& file) : impl_(std::make_unique<Impl>())
{
    impl_->name = file.string();
    impl_->file = std::fopen(impl_->name.c_str(), "w");
    if (!impl_->file) fail(impl_->name, ": cannot be written");
    std::fputs("step,time [s],dt [s],flags,iterations,hash\n", impl_->file);
}

StepTable::~StepTable() { std::fclose(impl_->file); }

void StepTable::drain(physics::PhysicsServer& server)
{
    while (const physics::StepRecord* record = server.nextRecord()) {
        int iterations = 0;
        for (const physics::BodySolve& solve : record->report.solves) iterations += solve.iterations;
        std::fprintf(impl_->file, "%" PRIu64 ",%.17g,%.17g,%" PRIu32 ",%d,%016" PRIx64 "\n", record->report.step,
                     record->report.time, record->report.dt, record->report.flags, iterations, record->hash);
        server.popRecord();
    }
    if (std::fflush(impl_->file) != 0) fail(impl_->name, ": cannot be written (disk full?)");
}

std::optional<Difference> replay(const std::vector<StepRecord>& steps, physics::PhysicsEngine& fresh)
{
    for (const StepRecord& step : steps) {
        if (step.report.has(StepFlag::RecordLost)) fail("step ", step.report.step, ": a step before it was lost");
        std::vector<Command> commands;
        for (const Command& command : step.commands) commands.push_back(std::visit(Again{fresh}, command));
        fresh.step({.dt = step.report.dt, .commands = commands});
        if (step.hash == 0) continue;
        if (const std::uint64_t hash = fresh.hash(); hash != step.hash)
            return Difference{step.report.step, step.hash, hash};
    }
    return std::nullopt;
}

} // namespace filasofia::record
