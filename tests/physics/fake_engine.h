#pragma once

#include "filasofia/core/error.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/physics/physics_server.h"

#include <string>

namespace filasofia::physics {

struct FakeBody final : BuiltBody {
    int nodes = 0;
    [[nodiscard]] int nodeCount() const override { return nodes; }
};

/// What a fake engine was asked to do. It outlives the server that owns the engine.
struct Told {
    std::vector<Command> commands; ///< all, in the order in which they arrived
    std::vector<double> dts;       ///< one per step
    int captures = 0;
    int hashes = 0;
};

/// An engine that moves nothing and writes down what it is told. Soft bodies have four nodes.
class FakeEngine final : public PhysicsEngine {
public:
    explicit FakeEngine(Told& told) : told_(told) {}

    [[nodiscard]] std::unique_ptr<BuiltBody> build(const BodyDef& def) const override
    {
        auto body = std::make_unique<FakeBody>();
        const auto* rigid = std::get_if<RigidBodyDef>(&def);
        body->nodes = rigid ? static_cast<int>(rigid->elements.size()) : 4;
        return body;
    }
    StepReport step(const StepInput& in) override
    {
        for (Command& command : in.commands) {
            if (auto* tune = std::get_if<Tune>(&command)) tune->change(*this);
            told_.commands.push_back(taken(command));
        }
        told_.dts.push_back(in.dt);
        ++steps_;
        return {.step = steps_, .time = 0.5, .dt = in.dt, .flags = in.flags};
    }
    void capture(frame::Frame& out) const override
    {
        ++told_.captures;
        out.step = steps_;
    }
    void record(StepRecord& out) const override { out.rigidPoses.assign(2, Pose{}); }
    [[nodiscard]] std::uint64_t hash() const override
    {
        ++told_.hashes;
        return 1000 + steps_;
    }

private:
    /// As the seam says: the built body is moved out, the rest of the command stays for the log.
    static Command taken(Command& command)
    {
        if (auto* add = std::get_if<AddBody>(&command)) return AddBody{add->id, add->def, std::move(add->body)};
        Command copy;
        std::visit(
            [&](auto& each) {
                if constexpr (std::is_copy_constructible_v<std::remove_reference_t<decltype(each)>>) copy = each;
            },
            command);
        return copy;
    }

    Told& told_;
    std::uint64_t steps_ = 0;
};

inline PhysicsServer fakeServer(Told& told, const PhysicsServerDef& def = {})
{
    return PhysicsServer(std::make_unique<FakeEngine>(told), def);
}

/// The command at `place`, which must be of kind C.
template <class C> const C& command(const Told& told, std::size_t place)
{
    REQUIRE(place < told.commands.size());
    const C* found = std::get_if<C>(&told.commands[place]);
    REQUIRE(found != nullptr);
    return *found;
}

/// A mesh of one tetrahedron, as the mesh of a Def.
inline std::shared_ptr<const geometry::TetMesh> oneTetrahedron()
{
    const geometry::TetMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}};
    return std::make_shared<const geometry::TetMesh>(mesh);
}

/// Runs `act` and holds its Error against every part of the message.
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
