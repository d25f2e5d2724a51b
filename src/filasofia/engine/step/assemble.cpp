#include "filasofia/engine/body/each_body.h"
#include "filasofia/engine/step/stages.h"

namespace filasofia::engine {
namespace {

/// The forces that are there without any deformation: weight, what the user gave, pins, pressure on the surface.
void addGivenForces(const SoftModel& model, Vec3 gravity, const SoftState& state, std::vector<Vec3>& forces)
{
    for (std::size_t i = 0; i < forces.size(); ++i)
        forces[i] = state.forces[i] + (model.gravity ? model.masses[i] * gravity : Vec3{});
    addPinForces(model.pins, state.x, forces);
    if (state.pressure == 0.0) return;
    for (const geometry::Triangle& t : model.surface) {
        const Vec3 area = 0.5 * cross(state.x[t[1]] - state.x[t[0]], state.x[t[2]] - state.x[t[0]]); // outwards
        for (int node : t) forces[node] -= state.pressure / 3.0 * area;
    }
}

} // namespace

void assembleBody(const SoftModel& model, Vec3 gravity, double dt, double inertia, SoftState& state, SoftSystem& system,
                  WorkerPool& pool)
{
    addGivenForces(model, gravity, state, system.forces);
    if (system.matrixFree)
        system.matrixFree->assemble(model, system.forces, dt, inertia, state, pool);
    else
        assembleMatrix(model, system.forces, dt, inertia, state, *system.assembled);
}

void assemble(const Model& model, double dt, State& state, Systems& systems, WorkerPool& pool)
{
    if (dt == 0.0) return;
    forEachBody(model, pool, [&](std::size_t b) {
        assembleBody(model.softBodies[b], state.gravity, dt, 1.0, state.softBodies[b], systems[b], pool);
    });
}

} // namespace filasofia::engine
