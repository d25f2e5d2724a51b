#include "filasofia/engine/integrate/euler.h"
#include "filasofia/engine/stages.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

void advanceBody(const SoftModel& model, double dt, SoftSystem& system, SoftState& state, physics::StepReport& report)
{
    system.x = state.x;
    system.v = state.v;
    system.dv = state.dv;
    if (system.solver) {
        const linalg::SolveReport solve = system.solver->solve(system.matrix, system.rightHandSide, system.dv);
        report.solves.push_back({model.id, solve.iterations, solve.residual});
        if (!solve.converged) report.set(physics::StepFlag::NotConverged);
        advanceImplicit(dt, system.dv, system.x, system.v);
    } else {
        const bool symplectic = std::get<physics::ExplicitEuler>(model.integrator).symplectic;
        advanceExplicit(dt, symplectic, {model.rayleigh.mass, model.rayleigh.stiffness}, model.masses, system.forces,
                        system.stiffnessTimesVelocity, model.pins.hard, system.x, system.v);
        report.solves.push_back({model.id, 0, 0.0});
    }
    if (usable(system.x) && usable(system.v)) {
        std::swap(system.x, state.x);
        std::swap(system.v, state.v);
        std::swap(system.dv, state.dv);
    } else { // stay where it was, and forget the motion that led here
        std::fill(state.v.begin(), state.v.end(), Vec3{});
        std::fill(state.dv.begin(), state.dv.end(), Vec3{});
        report.set(physics::StepFlag::Undone);
    }
}

} // namespace

void advance(const Model& model, double dt, Systems& systems, State& state, physics::StepReport& report)
{
    if (dt > 0.0) {
        for (std::size_t b = 0; b < model.softBodies.size(); ++b)
            advanceBody(model.softBodies[b], dt, systems[b], state.softBodies[b], report);
        state.time += dt;
        ++state.step;
    }
    report.step = state.step;
    report.time = state.time;
}

} // namespace filasofia::engine
