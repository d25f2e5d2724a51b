#include "filasofia/testing/tissue_energy.h"

#include "filasofia/engine/body/nodal_volume.h"
#include "filasofia/engine/elastic/fibre.h"
#include "filasofia/engine/elastic/law.h"
#include "filasofia/math/polar.h"
#include "filasofia/math/svd.h"

#include <algorithm>
#include <cmath>

namespace filasofia::testing {
using namespace engine;
namespace {

Mat3 deformationOf(const FemElement& element, const std::vector<Vec3>& x)
{
    Corners at;
    for (std::size_t k = 0; k < 4; ++k) at[k] = x[static_cast<std::size_t>(element.nodes[k])];
    return gradient(element, at);
}

/// Elements whose nodes are all held, as those of removed pieces, count for nothing.
template <std::size_t n> bool isHeld(const SoftModel& model, const std::array<int, n>& nodes)
{
    return std::ranges::all_of(nodes, [&](int node) { return model.pins.hard[static_cast<std::size_t>(node)]; });
}

/// W = sum k_n / 2 theta_n^2 (nodal_volume.h).
double nodalEnergy(const SoftModel& model, const std::vector<Vec3>& x)
{
    if (!model.nodalVolumes) return 0.0;
    const std::vector<double> changes = volumeChanges(model, x);
    std::vector<double> stiffness(x.size());
    for (const FemElement& each : model.elements)
        for (const int node : each.nodes) stiffness[static_cast<std::size_t>(node)] += nodalShare(each);
    double sum = 0.0;
    for (std::size_t n = 0; n < changes.size(); ++n) sum += 0.5 * stiffness[n] * changes[n] * changes[n];
    return sum;
}

double tetrahedraEnergy(const SoftModel& model, const std::vector<Vec3>& x)
{
    double sum = 0.0;
    for (std::size_t e = 0; e < model.elements.size(); ++e) {
        const FemElement& element = model.elements[e];
        const Mat3 f = deformationOf(element, x);
        const Deformation at{f, toMat3(polarRotation(f, {}))};
        double density = energyDensity(model.material.law, lameOf(element), at);
        for (std::size_t k = 0; k < model.fibres.size(); ++k)
            density += fibreEnergy(model.material.fibres[k], model.fibres[k][e], f);
        sum += element.volume * density;
    }
    return sum + nodalEnergy(model, x);
}

} // namespace

double storedEnergy(const SoftBody& body)
{
    double sum = tetrahedraEnergy(body.model, body.state.x);
    for (const MembraneElement& each : body.model.shell.membranes)
        sum += membraneEnergy(each, vectorsAt(each.nodes, body.state.x));
    for (const BendingElement& each : body.model.shell.bends)
        sum += bendingEnergy(each, vectorsAt(each.nodes, body.state.x));
    return sum;
}

double energyOfMotion(const SoftBody& body, Vec3 gravity)
{
    double sum = 0.0;
    for (std::size_t n = 0; n < body.model.masses.size(); ++n) {
        const Vec3 v = body.state.v[n];
        sum += body.model.masses[n] * (0.5 * dot(v, v) - dot(gravity, body.state.x[n]));
    }
    return sum;
}

int surelyInverted(const SoftBody& body)
{
    constexpr double surely = -1e-4; // [-] det F
    return static_cast<int>(std::ranges::count_if(body.model.elements, [&](const FemElement& each) {
        return !isHeld(body.model, each.nodes) && determinant(deformationOf(each, body.state.x)) < surely;
    }));
}

double largestStrain(const SoftBody& body)
{
    double most = 0.0;
    for (const FemElement& each : body.model.elements) {
        if (isHeld(body.model, each.nodes)) continue;
        const Vec3 stretches = svd(deformationOf(each, body.state.x)).sigma;
        most = std::max({most, std::abs(stretches.x - 1.0), std::abs(stretches.z - 1.0)});
    }
    for (const MembraneElement& each : body.model.shell.membranes) most = std::max(most, strainOf(each, body.state.x));
    return most;
}

double largestInvariant(const SoftBody& body)
{
    const double range = physics::rangeOf(body.model.material.law);
    double most = 0.0;
    if (!std::isfinite(range)) return most;
    for (const FemElement& each : body.model.elements) {
        if (isHeld(body.model, each.nodes)) continue;
        const Vec3 s = svd(deformationOf(each, body.state.x)).sigma;
        const double volume = s.x * s.y * s.z;
        if (volume > 0.2) most = std::max(most, (lengthSquared(s) / std::pow(volume, 2.0 / 3.0) - 3.0) / range);
    }
    return most;
}

} // namespace filasofia::testing
