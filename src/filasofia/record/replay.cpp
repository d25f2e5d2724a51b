#include "filasofia/record/replay.h"

#include "filasofia/core/error.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/physics/physics_server.h"
#include "filasofia/physics/registry.h"
#include "filasofia/record/replayable.h"

#include <cmath>

namespace filasofia::record {
namespace {

using physics::Command;
using physics::StepRecord;

/// A recorded command, ready to be applied again: bodies are rebuilt from their Defs.
struct ReplayedCommand {
    const physics::PhysicsEngine& engine;

    Command operator()(const physics::AddBody& add) const
    {
        return physics::AddBody{add.id, add.def, engine.build(*add.def), add.attachments};
    }
    Command operator()(const physics::SetMaterial& set) const { return physics::SetMaterial{set.id, set.material}; }
    template <class Plain> Command operator()(const Plain& command) const { return command; }
};

} // namespace

struct Replayer::Impl {
    const physics::PhysicsEngine& builder; ///< builds bodies
    physics::PhysicsEngine* engine;        ///< computes the steps; null if the server does
    physics::PhysicsServer* server;
    /// A recording is not trusted: its commands get the same checks as those of a server's callers.
    physics::Registry bodies = {};
    std::uint64_t made = 0; ///< number of the last step

    void checkOrder(const StepRecord& recorded) const
    {
        const std::uint64_t step = recorded.report.step;
        if (const auto why = whyNotReplayable(recorded); !why.empty())
            fail("step ", step, " cannot be replayed: ", why);
        const bool paused = recorded.report.dt == 0.0; // computed, but not counted
        if (step != made + 1 && !(paused && step == made))
            fail("step ", step, " cannot be replayed: step ", made + 1, " is missing");
        if (!(std::isfinite(recorded.report.dt) && recorded.report.dt >= 0.0))
            fail("step ", step, ": dt must be >= 0 s, got ", recorded.report.dt);
    }

    std::vector<Command> commandsOf(const StepRecord& recorded)
    {
        std::vector<Command> commands;
        try {
            for (const Command& command : recorded.commands) {
                commands.push_back(std::visit(ReplayedCommand{builder}, command));
                bodies.check(commands.back());
                bodies.note(commands.back());
            }
        } catch (const Error& problem) {
            fail("step ", recorded.report.step, ": ", problem.what());
        }
        return commands;
    }

    /// If a step was not cut short, the iterations are not needed; a list of the wrong length is still an error.
    physics::StepBudget budgetOf(const StepRecord& recorded) const
    {
        const bool paused = recorded.report.dt == 0.0; // nothing is solved
        const std::size_t minimum = paused ? 0 : bodies.softBodyCount();
        const std::size_t maximum =
            paused ? 0 : minimum + bodies.dynamicElementCount(); // rigid bodies form groups by contacts
        if (const std::size_t count = recorded.report.solves.size(); count < minimum || count > maximum)
            fail("step ", recorded.report.step, ": iterations must have a number of entries in [", minimum, ", ",
                 maximum, "], one per solve, got ", count);
        physics::StepBudget budget;
        if (!recorded.report.has(physics::StepFlag::OutOfTime)) return budget;
        for (const physics::BodySolve& solve : recorded.report.solves) budget.iterations.push_back(solve.iterations);
        return budget;
    }
};

Replayer::Replayer(physics::PhysicsEngine& fresh) : impl_(new Impl{fresh, &fresh, nullptr}) {}
Replayer::Replayer(physics::PhysicsServer& fresh) : impl_(new Impl{fresh.engine(), nullptr, &fresh}) {}
Replayer::~Replayer() = default;

physics::StepReport Replayer::step(const StepRecord& recorded, const std::function<void()>& between)
{
    impl_->checkOrder(recorded);
    std::vector<Command> commands = impl_->commandsOf(recorded);
    const physics::StepBudget budget = impl_->budgetOf(recorded);
    impl_->made = recorded.report.step;
    const double dt = recorded.report.dt;
    if (!impl_->server) {
        if (between) between();
        return impl_->engine->step({.dt = dt, .commands = commands, .budget = &budget});
    }
    impl_->server->expect(std::move(commands));
    if (between) between();
    return impl_->server->replayStep(dt, budget);
}

std::optional<Difference> replay(const std::vector<StepRecord>& steps, physics::PhysicsEngine& fresh)
{
    Replayer replayer(fresh);
    for (const StepRecord& step : steps) {
        replayer.step(step);
        if (step.hash == 0) continue;
        if (const std::uint64_t hash = fresh.hash(); hash != step.hash)
            return Difference{step.report.step, step.hash, hash};
    }
    return std::nullopt;
}

} // namespace filasofia::record
