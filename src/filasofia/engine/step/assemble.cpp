#include "filasofia/engine/step/assemble.h"

#include "filasofia/engine/body/elements.h"
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

/// Reports the inverted elements of a body. Those of which every node is fixed, for example in a removed piece, are
/// left out: nothing will ever change them. If none of the bits says that there may be one, nothing is computed.
void findInverted(const SoftBody& body, physics::InvertedElements& report)
{
    const SoftModel& model = body.model;
    const auto look = [&](std::size_t e) {
        const FemElement& element = model.elements[e];
        const Corners corners = cornersOf(element.nodes, body.state.x);
        const double volume = determinant(gradient(element, corners));
        if (volume > 0.0 || allHeld(model, e)) return;
        ++report.count;
        if (!(volume < report.volume)) return;
        report.body = model.id;
        report.element = static_cast<int>(e);
        report.volume = volume;
        report.place = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
    };
    if (!body.system.matrixFree) {
        for (std::size_t e = 0; e < model.elements.size(); ++e) look(e);
        return;
    }
    const std::span<const std::uint16_t> bits = body.system.matrixFree->inverted();
    for (std::size_t block = 0; block < bits.size(); ++block)
        for (std::size_t lane = 0; lane < kBlock && bits[block] != 0; ++lane)
            if (const std::size_t e = kBlock * block + lane;
                (bits[block] >> lane & 1u) != 0 && e < model.elements.size())
                look(e);
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
    for (const SoftBody& body : scene.soft) findInverted(body, context.report.inverted);
    if (context.report.inverted.count > 0) context.report.set(physics::StepFlag::Inverted);
}

} // namespace filasofia::engine
