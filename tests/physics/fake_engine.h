#pragma once

#include "filasofia/core/error.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/physics/physics_server.h"

#include <string>

namespace filasofia::physics {

struct FakeBody final : BuiltBody {
    int nodes = 0;
    BodyDef def = {};                   ///< the Def that it was made from
    std::function<void()> counted = {}; ///< called by nodeCount()
    [[nodiscard]] int nodeCount() const override
    {
        if (counted) counted();
        return nodes;
    }
};

/// The calls that a fake engine received. It outlives the server that owns the engine.
struct EngineCalls {
    std::vector<Command> commands = {}; ///< all, in the order of arrival
    std::vector<double> dts = {};       ///< one per step
    int captures = 0;
    int hashes = 0;
    std::vector<std::int64_t> deadlines = {}; ///< one per step that had a clock

    std::function<void(const Command&, const BodyDef*)> check = {}; ///< may throw: the engine refuses a command

    int needed = 0;                     ///< iterations that each soft body's solver makes if nothing stops it
    std::function<void()> build = {};   ///< called while a body is built
    std::function<void()> counted = {}; ///< called by nodeCount() of every body that is built from now on
    std::function<void()> iterate = {}; ///< called for each iteration: a fake clock can advance here
    std::vector<std::vector<int>> iterations = {}; ///< iterations made, per step and soft body
};

/// An engine that moves nothing and records its calls. Soft bodies have four nodes. The hash depends only on the number
/// of the step and the solvers' iterations.
class FakeEngine final : public PhysicsEngine {
public:
    explicit FakeEngine(EngineCalls& calls) : calls_(calls) {}

    [[nodiscard]] EngineInfo info() const override { return {.name = "fake"}; }
    void check(const Command& command, const BodyDef* def) const override
    {
        if (calls_.check) calls_.check(command, def);
    }
    [[nodiscard]] std::unique_ptr<BuiltBody> build(const BodyDef& def) const override
    {
        auto body = std::make_unique<FakeBody>();
        const auto* rigid = std::get_if<RigidBodyDef>(&def);
        body->def = def;
        if (calls_.build) calls_.build();
        body->counted = calls_.counted;
        body->nodes = rigid ? static_cast<int>(rigid->elements.size()) : 4;
        return body;
    }
    StepReport step(const StepInput& in) override
    {
        for (Command& command : in.commands) {
            if (auto* tune = std::get_if<Tune>(&command)) tune->change(*this);
            if (const auto* add = std::get_if<AddBody>(&command))
                softBodies_ += std::holds_alternative<SoftBodyDef>(*add->def);
            calls_.commands.push_back(taken(command));
        }
        calls_.dts.push_back(in.dt);
        ++steps_;
        StepReport report{.step = steps_, .time = 0.5, .dt = in.dt, .flags = in.flags};
        if (calls_.needed > 0) solve(in.budget ? *in.budget : StepBudget{}, report);
        if (in.budget && in.budget->now) calls_.deadlines.push_back(in.budget->deadline);
        return report;
    }
    void capture(frame::Frame& out) const override
    {
        ++calls_.captures;
        out.step = steps_;
    }
    void record(StepRecord& out) const override { out.rigidPoses.assign(2, Pose{}); }
    [[nodiscard]] std::uint64_t hash() const override
    {
        ++calls_.hashes;
        return 1000 + steps_ + 1'000'000 * iterationsMade_;
    }

    [[nodiscard]] std::shared_ptr<const EngineState> save() const override
    {
        auto state = std::make_shared<State>();
        state->steps = steps_;
        return state;
    }
    void restore(const EngineState& state) override { steps_ = dynamic_cast<const State&>(state).steps; }

private:
    struct State final : EngineState {
        std::uint64_t steps = 0;
    };
    /// As the seam requires: the built body is moved out, the rest of the command stays for the log.
    static Command taken(Command& command)
    {
        if (auto* add = std::get_if<AddBody>(&command))
            return AddBody{add->id, add->def, std::move(add->body), add->attachments};
        if (auto* set = std::get_if<SetMaterial>(&command))
            return SetMaterial{set->id, set->material, std::move(set->body)};
        Command copy;
        std::visit(
            [&](auto& each) {
                if constexpr (std::is_copy_constructible_v<std::remove_reference_t<decltype(each)>>) copy = each;
            },
            command);
        return copy;
    }

    /// As the seam requires: the deadline is checked between iterations; recorded counts replace it.
    void solve(const StepBudget& budget, StepReport& report)
    {
        calls_.iterations.emplace_back();
        for (std::size_t body = 0; body < softBodies_; ++body) {
            const int wanted = budget.iterations.empty() ? calls_.needed : budget.iterations[body];
            int made = 0;
            for (; made < wanted && !(budget.now && budget.now() >= budget.deadline); ++made)
                if (calls_.iterate) calls_.iterate();
            if (made < wanted) report.set(StepFlag::OutOfTime);
            iterationsMade_ = 31 * iterationsMade_ + static_cast<std::uint64_t>(made);
            report.solves.push_back({.body = {}, .iterations = made});
            calls_.iterations.back().push_back(made);
        }
    }

    EngineCalls& calls_;
    std::uint64_t steps_ = 0;
    std::size_t softBodies_ = 0;
    std::uint64_t iterationsMade_ = 0;
};

inline PhysicsServer fakeServer(EngineCalls& calls, const PhysicsServerDef& def = {})
{
    return PhysicsServer(std::make_unique<FakeEngine>(calls), def);
}

/// The command at `place`, which must be of kind C.
template <class C> const C& command(const EngineCalls& calls, std::size_t place)
{
    REQUIRE(place < calls.commands.size());
    const C* found = std::get_if<C>(&calls.commands[place]);
    REQUIRE(found != nullptr);
    return *found;
}

/// A mesh of one tetrahedron, as the mesh of a Def.
inline std::shared_ptr<const geometry::TetMesh> oneTetrahedron()
{
    const geometry::TetMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}};
    return std::make_shared<const geometry::TetMesh>(mesh);
}

/// Runs `act` and checks that its Error contains every part.
template <class Act> void checkError(Act&& act, const std::vector<std::string>& parts)
{
    try {
        act();
        FAIL("no Error was thrown");
    } catch (const Error& error) {
        for (const std::string& part : parts) CHECK_THAT(error.what(), Catch::Contains(part));
    }
}

} // namespace filasofia::physics
