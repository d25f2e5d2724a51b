#pragma once

#include "filasofia/core/error.h"
#include "filasofia/engine/scene/snapshot.h"
#include "filasofia/engine/world.h"

#include "engine/meshes.h"

namespace filasofia::engine {

/// A World stepped by hand: commands wait for the next step, as with the server.
struct Stage {
    explicit Stage(const NativeEngineDef& def = {.threads = 1}) : world(def) {}

    World world;
    std::vector<physics::Command> commands;
    std::uint32_t lastId = 0;
    std::uint32_t lastAttachment = 0;

    BodyId add(const physics::BodyDef& def)
    {
        const BodyId id{++lastId};
        const AttachmentId first{lastAttachment + 1};
        lastAttachment +=
            std::visit([](const auto& d) { return static_cast<std::uint32_t>(d.attachments.size()); }, def);
        post(physics::AddBody{id, std::make_shared<const physics::BodyDef>(def), world.build(def), first});
        return id;
    }
    template <class C> void post(C command) { commands.emplace_back(std::in_place_type<C>, std::move(command)); }
    physics::StepReport step(double dt)
    {
        const physics::StepReport report = world.step({.dt = dt, .commands = commands});
        commands.clear();
        return report;
    }
    physics::StepReport run(int steps, double dt)
    {
        physics::StepReport all;
        for (int i = 0; i < steps; ++i) {
            const std::uint32_t flags = all.flags;
            all = step(dt);
            all.flags |= flags;
        }
        return all;
    }
    SoftModel& model(std::size_t body = 0) { return world.scene().soft[body].model; }
    SoftState& soft(std::size_t body = 0) { return world.scene().soft[body].state; }
};

/// A body without gravity, damping and pins, so that only what a test adds acts. It uses double precision for exact
/// answers.
inline physics::SoftBodyDef freeBody(geometry::TetMesh mesh)
{
    return {.mesh = shared(std::move(mesh)),
            .rayleigh = {0.0, 0.0},
            .gravity = false,
            .solver = physics::ConjugateGradient{.tolerance = 1e-4, .assembled = true}};
}

/// The forces on the nodes of a free body, at rest or moving, from one explicit step on a copy of its state: the body
/// must use an explicit integrator.
inline std::vector<Vec3> forcesNow(Stage& stage, std::size_t body = 0)
{
    const Snapshot before(stage.world.scene());
    constexpr double dt = 1e-9;
    stage.step(dt);
    std::vector<Vec3> forces;
    for (std::size_t i = 0; i < stage.soft(body).v.size(); ++i)
        forces.push_back(stage.model(body).masses[i] / dt * (stage.soft(body).v[i] - before.softState(body).v[i]));
    before.restore(stage.world.scene());
    return forces;
}

inline double meshVolume(const SoftModel& model, const std::vector<Vec3>& x)
{
    double volume = 0.0;
    for (const FemElement& e : model.elements)
        volume += geometry::signedVolume(x[e.nodes[0]], x[e.nodes[1]], x[e.nodes[2]], x[e.nodes[3]]);
    return volume;
}

inline int invertedElements(const SoftModel& model, const SoftState& state)
{
    int count = 0;
    for (const FemElement& e : model.elements)
        count += !(geometry::signedVolume(state.x[e.nodes[0]], state.x[e.nodes[1]], state.x[e.nodes[2]],
                                          state.x[e.nodes[3]]) > 0.0);
    return count;
}

/// Root mean square distance between two lists of points, relative to `size`.
inline double relativeDistance(const std::vector<Vec3>& a, const std::vector<Vec3>& b, double size)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += lengthSquared(a[i] - b[i]);
    return std::sqrt(sum / static_cast<double>(a.size())) / size;
}

} // namespace filasofia::engine
