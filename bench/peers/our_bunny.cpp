#include "bench/peers/our_bunny.h"

#include "filasofia/engine/native_engine.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/physics/physics_server.h"

#include <chrono>

namespace filasofia::peers {

Run runOurs(const Problem& problem, const physics::Solver& solver)
{
    using Clock = std::chrono::steady_clock;
    physics::PhysicsServer server(engine::makeNativeEngine({.period = problem.dt, .threads = 1}),
                                  {.gravity = {0.0, -kGravity, 0.0}});
    const BodyId bunny = server.add(
        physics::SoftBodyDef{.name = "bunny",
                             .mesh = problem.mesh,
                             .material = physics::FemMaterial{kYoungModulus, kPoissonRatio, physics::Corotational{}},
                             .mass = physics::Density{kDensity},
                             .rayleigh = {problem.rayleighMass, problem.rayleighStiffness},
                             .solver = solver,
                             .attachments = {{.nodes = problem.pinned}}});
    Run run;
    for (int step = 0; step < problem.steps; ++step) {
        const Clock::time_point before = Clock::now();
        const physics::StepReport report = server.step(problem.dt);
        run.seconds.push_back(std::chrono::duration<double>(Clock::now() - before).count());
        run.iterations += report.solves.front().iterations / static_cast<double>(problem.steps);
        run.unsolved += report.has(physics::StepFlag::NotConverged) ? 1 : 0;
    }
    run.positions = server.latest()->softBody(bunny)->positions;
    return run;
}

} // namespace filasofia::peers
