#include "filasofia/engine/soft/soft_system.h"

#include "filasofia/core/log.h"
#include "filasofia/math/rounded.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace filasofia::engine {
namespace {

// [-] Cubes of 4^3 cells that fell on a floor rested and bore their weight up to 7e6, at 100 Hz to 1 kHz; from 2e7 on
// they were thrown, by up to 20 m/s, at rates and sizes of element that differ.
constexpr double kStiffest = 5e6;

/// [-] The stiffness of an element in the matrix of the implicit step, relative to the mean mass of a node.
double stiffnessOverMass(const FemElement& element, double weight, double mass)
{
    const auto [mu, lambda] = lame(element.youngModulus, element.poissonRatio);
    double steepest = 0.0;
    for (const Vec3& each : element.gradients) steepest = std::max(steepest, lengthSquared(each));
    return weight * element.volume * steepest * (lambda + 2.0 * mu) / mass;
}

} // namespace

void warnOfStiffness(const SoftModel& model, double period)
{
    if (model.collision.empty() || !std::holds_alternative<physics::ImplicitEuler>(model.integrator)) return;
    const double weight = implicitWeights(period, {model.rayleigh.mass, model.rayleigh.stiffness}).stiffness;
    const double mass =
        std::accumulate(model.masses.begin(), model.masses.end(), 0.0) / static_cast<double>(model.masses.size());
    double most = kStiffest, given = 0.0;
    for (const FemElement& each : model.elements)
        if (const double now = stiffnessOverMass(each, weight, mass); now > most) most = now, given = each.youngModulus;
    if (given > 0.0)
        logWarning("soft body '", model.name, "': a Young's modulus of ", given,
                   " Pa in elements so small is too stiff for ", std::round(1.0 / period),
                   " steps per second: contact may throw the body. ", advised(given * kStiffest / most),
                   " Pa would do, or more steps per second, or a rigid body");
}

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
