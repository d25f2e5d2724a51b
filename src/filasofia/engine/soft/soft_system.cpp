#include "filasofia/engine/soft/soft_system.h"

#include "filasofia/core/log.h"

#include <algorithm>

namespace filasofia::engine {
SoftSystem::SoftSystem(const SoftSystem& other)
    : matrixFree(other.matrixFree), rod(other.rod), held(other.held), tuned(other.tuned),
      outdated(other.outdated || other.assembled), forces(other.forces), x(other.x), v(other.v), dv(other.dv),
      residual(other.residual)
{
}

SoftSystem& SoftSystem::operator=(const SoftSystem& other)
{
    if (this != &other) *this = SoftSystem(other);
    return *this;
}

void followTissue(const SoftModel& model, const std::vector<int>& elements, SoftSystem& system)
{
    system.tuned = true;
    listVolumes(model, system.held);
    if (system.outdated) return;
    if (system.matrixFree) system.outdated = !system.matrixFree->editTissue(model, elements);
    if (system.assembled) system.outdated = !system.assembled->holds(model, elements); // it reads them in every step
}

SoftSystem makeSystem(const SoftModel& model, double period)
{
    SoftSystem system;
    for (auto* buffer : {&system.forces, &system.x, &system.v, &system.dv, &system.residual})
        buffer->resize(model.rest.size());
    system.held = pinnedParts(model);
    if (isRod(model)) {
        system.rod = std::make_unique<RodSystem>(model);
        return system;
    }
    const auto* cg = std::get_if<physics::ConjugateGradient>(&model.solver);
    const bool wanted = cg && !cg->assembled;
    if (wanted && MatrixFreeSystem::fits(model, period))
        system.matrixFree = std::make_unique<MatrixFreeSystem>(model, period);
    else
        system.assembled = std::make_unique<AssembledSystem>(model);
    if (wanted && !system.matrixFree)
        logWarning("soft body '", model.name,
                   "': its masses and stiffnesses span too wide a range for single precision; ",
                   "it is solved in double precision, which is slower");
    return system;
}

} // namespace filasofia::engine
