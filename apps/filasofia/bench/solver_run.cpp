#include "apps/filasofia/bench/solver_run.h"

#include "filasofia/core/text.h"
#include "filasofia/engine/native/native.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/geometry/mesh_file.h"
#include "filasofia/geometry/refine.h"
#include "filasofia/runtime/assets.h"
#include "filasofia/runtime/clock.h"

#include <algorithm>
#include <cmath>

namespace filasofia::app {

std::shared_ptr<const geometry::TetMesh> bunnyMesh(int tets)
{
    const int file = tets == kLargestBunny ? 1492 : tets;
    geometry::TetMesh mesh = geometry::loadTetMesh(runtime::asset(text("meshes/bunny_", file, ".msh")));
    if (tets == kLargestBunny) mesh = geometry::refined(geometry::refined(mesh));
    return std::make_shared<const geometry::TetMesh>(std::move(mesh));
}

physics::SoftBodyDef solverBunny(std::shared_ptr<const geometry::TetMesh> mesh, Hold hold,
                                 const physics::Solver& solver, const physics::FemMaterial& material)
{
    const geometry::Box head{{-1, 0.105, -1}, {1, 1, 1}}, feet{{-1, -1, -1}, {1, 0.045, 1}};
    return {.name = "bunny",
            .mesh = std::move(mesh),
            .material = material,
            .mass = physics::Density{1000.0},
            .rayleigh = {.mass = 0.1, .stiffness = 0.01},
            .solver = solver,
            .attachments = {{.box = hold == Hold::Head ? head : feet}}};
}

SolverRun::SolverRun(const physics::SoftBodyDef& def, double dt, int threads)
    : engine_(engine::makeNativeEngine({.period = dt, .threads = threads})), dt_(dt)
{
    const auto shared = std::make_shared<const physics::BodyDef>(def);
    std::vector<physics::Command> commands;
    commands.emplace_back(physics::SetGravity{kSolverGravity});
    commands.emplace_back(physics::AddBody{BodyId{1}, shared, engine_->build(*shared)});
    engine_->step({.dt = 0.0, .commands = commands});
}

physics::StepReport SolverRun::step() { return engine_->step({.dt = dt_, .commands = {}}); }

void SolverRun::backToRest()
{
    std::array<physics::Command, 1> commands{physics::Reset{}};
    engine_->step({.dt = 0.0, .commands = commands});
}

frame::SoftBodyFrame SolverRun::state() const
{
    frame::Frame frame;
    engine_->capture(frame);
    return std::move(frame.softBodies.front());
}

double distanceOf(const std::vector<Vec3>& a, const std::vector<Vec3>& b)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += lengthSquared(a[i] - b[i]);
    return std::sqrt(sum);
}

ColdReference::ColdReference(std::shared_ptr<const geometry::TetMesh> mesh, double dt)
    : server_(engine::makeNativeEngine({.period = dt, .threads = 1}), {.gravity = kSolverGravity}), dt_(dt)
{
    constexpr physics::ConjugateGradient solver{.maxIterations = 100000, .tolerance = 1e-6, .assembled = true};
    server_.add(solverBunny(std::move(mesh), Hold::Head, solver));
}

// The solver starts from the last step's solution; tune() clears it. tune() runs within the step, but in the stage of
// the commands, which is not timed. The frame pool would be another such stage, so only the engine's own times are
// reported.
physics::StepReport ColdReference::step(const frame::SoftBodyFrame* from)
{
    engine::tune(server_, [from](engine::Native& native) {
        const engine::NativeSoftBody body = native.softBody(native.softBodies().front());
        std::ranges::fill(body.velocityChanges, Vec3{});
        if (!from) return;
        std::ranges::copy(from->positions, body.positions.begin());
        std::ranges::copy(from->velocities, body.velocities.begin());
    });
    return server_.step(dt_, 0, {.now = runtime::steadyClock().now});
}

} // namespace filasofia::app
