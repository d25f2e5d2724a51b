#include "filasofia/engine/step/assemble.h"

#include "filasofia/engine/scene/each_body.h"

namespace filasofia::engine {
namespace {

/// Computes the forces other than elasticity and damping: weight, the user's forces, pin springs, pressure on the
/// surface.
void addExternalForces(const SoftModel& model, Vec3 gravity, const SoftState& state, std::vector<Vec3>& forces)
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

void assembleBody(const Assembly& how, SoftBody& body, WorkerPool& pool)
{
    SoftSystem& system = body.system;
    addExternalForces(body.model, how.gravity, body.state, system.forces);
    if (system.matrixFree)
        system.matrixFree->assemble(body.model, system.forces, how.dt, how.inertia, body.state, pool);
    else
        assembleMatrix(body.model, system.forces, how.dt, how.inertia, body.state, *system.assembled);
}

void assemble(const StepContext& context, Scene& scene)
{
    if (context.dt == 0.0) return;
    forEachBody(scene, context.pool, [&](SoftBody& body, std::size_t) {
        assembleBody({scene.gravity, context.dt, 1.0}, body, context.pool);
    });
}

} // namespace filasofia::engine
