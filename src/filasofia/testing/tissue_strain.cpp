#include "filasofia/testing/tissue_strain.h"

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

} // namespace

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
