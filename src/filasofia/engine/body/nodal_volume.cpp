#include "filasofia/engine/body/nodal_volume.h"

#include "filasofia/engine/rupture/tet_shape.h"

#include <algorithm>
#include <numeric>

namespace filasofia::engine {
namespace {

/// Per node: the mean of a value of the elements around it, by their shares.
template <class ValueOf>
std::vector<double> nodalMeans(const SoftModel& model, std::span<const int> elements, const ValueOf& valueOf)
{
    if (!model.nodalVolumes || elements.empty()) return {};
    std::vector<double> sums(model.rest.size()), stiffness(model.rest.size());
    for (int e : elements) {
        const FemElement& element = model.elements[static_cast<std::size_t>(e)];
        const double share = nodalShare(element);
        if (share == 0.0) continue;
        const double value = share * valueOf(element);
        for (int node : element.nodes) {
            sums[static_cast<std::size_t>(node)] += value;
            stiffness[static_cast<std::size_t>(node)] += share;
        }
    }
    for (std::size_t n = 0; n < sums.size(); ++n)
        if (stiffness[n] > 0.0) sums[n] /= stiffness[n];
    return sums;
}

} // namespace

bool hasNodalVolumes(const std::vector<FemElement>& elements)
{
    return std::ranges::any_of(elements, [](const FemElement& each) { return nodalBulk(each) > 0.0; });
}

std::vector<double> volumeChanges(const SoftModel& model, const std::vector<Vec3>& x, std::span<const int> elements)
{
    return nodalMeans(model, elements, [&](const FemElement& each) {
        return determinant(gradient(each, cornersOf(each.nodes, x))) - 1.0;
    });
}

std::vector<double> volumeRates(const SoftModel& model, const SoftState& state, std::span<const int> elements)
{
    return nodalMeans(model, elements, [&](const FemElement& each) {
        const Mat3 f = gradient(each, cornersOf(each.nodes, state.x));
        return contract(cofactor(f), gradient(each, cornersOf(each.nodes, state.v)));
    });
}

std::vector<double> volumeChanges(const SoftModel& model, const std::vector<Vec3>& x)
{
    std::vector<int> all(model.nodalVolumes ? model.elements.size() : 0);
    std::iota(all.begin(), all.end(), 0);
    return volumeChanges(model, x, all);
}

double nodalTension(const FemElement& element, std::span<const double> changes)
{
    if (changes.empty()) return 0.0;
    double sum = 0.0;
    for (int node : element.nodes) sum += changes[static_cast<std::size_t>(node)];
    return 0.25 * sum * nodalBulk(element);
}

Corners volumeGradients(const FemElement& element, const Mat3& f)
{
    const Mat3 c = cofactor(f);
    Corners out;
    for (std::size_t i = 0; i < 4; ++i) out[i] = c * element.gradients[i];
    return out;
}

} // namespace filasofia::engine
