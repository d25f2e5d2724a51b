#include "filasofia/engine/body/elastic_energy.h"

#include "filasofia/engine/body/nodal_volume.h"
#include "filasofia/engine/elastic/fibre.h"
#include "filasofia/engine/elastic/law.h"
#include "filasofia/engine/elastic/relaxation.h"
#include "filasofia/math/polar.h"

namespace filasofia::engine {
namespace {

/// A node of an element says it for the element: pieces share no nodes.
bool isGone(const std::vector<bool>& gone, int node) { return !gone.empty() && gone[static_cast<std::size_t>(node)]; }

/// W = sum k_n / 2 theta_n^2 (nodal_volume.h).
double nodalEnergy(const SoftModel& model, const std::vector<Vec3>& x, const std::vector<bool>& gone)
{
    if (!model.nodalVolumes) return 0.0;
    const std::vector<double> changes = volumeChanges(model, x);
    std::vector<double> stiffness(x.size());
    for (const FemElement& each : model.elements)
        for (const int node : each.nodes) stiffness[static_cast<std::size_t>(node)] += nodalShare(each);
    double sum = 0.0;
    for (std::size_t n = 0; n < changes.size(); ++n)
        if (!isGone(gone, static_cast<int>(n))) sum += 0.5 * stiffness[n] * changes[n] * changes[n];
    return sum;
}

/// What relaxes is in the terms of the series, and counts for nothing: only the law's share that never relaxes does.
double tetrahedraEnergy(const SoftModel& model, const std::vector<Vec3>& x, const std::vector<bool>& gone)
{
    const double lasting = relaxationStep(model.material.relaxation, 0.0, 0.0).present;
    double sum = 0.0;
    for (std::size_t e = 0; e < model.elements.size(); ++e) {
        const FemElement& element = model.elements[e];
        if (isGone(gone, element.nodes[0])) continue;
        const Mat3 f = gradient(element, vectorsAt(element.nodes, x));
        const Deformation at{f, toMat3(polarRotation(f, {}))};
        double density = lasting * energyDensity(model.material.law, lameOf(element), at);
        for (std::size_t k = 0; k < model.fibres.size(); ++k)
            density += fibreEnergy(model.material.fibres[k], model.fibres[k][e], f);
        sum += element.volume * density;
    }
    return sum + nodalEnergy(model, x, gone);
}

double rodEnergy(const SoftModel& model, const SoftState& state)
{
    const Rod& rod = model.rod;
    double sum = 0.0;
    for (std::size_t e = 0; e < rod.edges.size(); ++e)
        if (const auto [a, b] = rod.edges[e].nodes; !isCut(rod, e))
            sum +=
                springEnergy(rod.edges[e], state.x[static_cast<std::size_t>(a)], state.x[static_cast<std::size_t>(b)]);
    const std::vector<RodJoint> joints = stiffJoints(rod, model.pins.hard); // zero where an edge is cut
    for (std::size_t j = 0; j < joints.size(); ++j)
        sum += rodEnergy(jointNow(rod, joints[j], state.rod, j), placeAt(state.rod, state.x, j));
    return sum;
}

} // namespace

double elasticEnergy(const SoftModel& model, const SoftState& state, const std::vector<bool>& gone)
{
    if (isRod(model)) return rodEnergy(model, state);
    double sum = tetrahedraEnergy(model, state.x, gone);
    for (const Spring& each : model.springs)
        if (!isGone(gone, each.nodes[0])) {
            const auto [a, b] = vectorsAt(each.nodes, state.x);
            sum += springEnergy(each, a, b);
        }
    for (const MembraneElement& each : model.shell.membranes)
        if (!isGone(gone, each.nodes[0])) sum += membraneEnergy(each, vectorsAt(each.nodes, state.x));
    for (const BendingElement& each : model.shell.bends)
        if (!isGone(gone, each.nodes[0])) sum += bendingEnergy(each, vectorsAt(each.nodes, state.x));
    return sum;
}

} // namespace filasofia::engine
