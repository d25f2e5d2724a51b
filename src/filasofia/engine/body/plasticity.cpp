#include "filasofia/engine/body/plasticity.h"

#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/body/tissue.h"
#include "filasofia/linalg/node_parts.h"
#include "filasofia/math/svd.h"

#include <cmath>

namespace filasofia::engine {
namespace {

constexpr double kLeast = 1e-3;   // [-] smaller excess over the yield stress is left to the next step
constexpr double kMostFlow = 5.0; // [-] norm of F_p, sqrt(3) at the start
constexpr int kElementsPerPart = 256;

/// [-] The part of a distortion, as logarithmic strain, at which the law bears `share` of its von Mises stress.
double shrunk(const SoftModel& model, const FemElement& element, Vec3 mean, Vec3 distortion, double share)
{
    const auto stressAt = [&](double part) {
        const Vec3 strain = mean + part * distortion;
        const Mat3 f = Mat3::diagonal({std::exp(strain.x), std::exp(strain.y), std::exp(strain.z)});
        return vonMises(cauchyStress(model.material.law, lameOf(element), {f, Mat3::identity()}));
    };
    const double wanted = share * stressAt(1.0);
    double low = 0.0, high = 1.0;
    for (int k = 0; k < 40; ++k) {
        const double middle = 0.5 * (low + high);
        (stressAt(middle) < wanted ? low : high) = middle;
    }
    return low;
}

bool flowElement(const SoftModel& model, const SoftState& state, std::size_t e, FemElement& element)
{
    const Mat3 f = gradient(element, cornersOf(element.nodes, state.x));
    if (determinant(f) <= 0.0) return false; // inside out: it has no logarithmic strain
    const double stress = vonMises(endStress(model, state, e, f));
    if (!(stress > (1.0 + kLeast) * element.yieldStress)) return false;
    const Svd parts = svd(f);
    const Vec3 strain{std::log(parts.sigma.x), std::log(parts.sigma.y), std::log(parts.sigma.z)};
    const Vec3 mean = (strain.x + strain.y + strain.z) / 3.0 * Vec3{1, 1, 1}, distortion = strain - mean;
    const double left = shrunk(model, element, mean, distortion, element.yieldStress / stress);
    const Vec3 flown = (1.0 - left) * distortion;
    const Mat3 stretch = Mat3::diagonal({std::exp(flown.x), std::exp(flown.y), std::exp(flown.z)});
    const Mat3 plastic = parts.v * stretch * transpose(parts.v) * element.plastic;
    if (!(frobeniusNorm(plastic) < kMostFlow)) return false;
    element.plastic = std::cbrt(1.0 / determinant(plastic)) * plastic;
    shapeElement(model.rest, element);
    return true;
}

} // namespace

double vonMises(const Mat3& stress)
{
    return std::sqrt(1.5) * frobeniusNorm(stress - trace(stress) / 3.0 * Mat3::identity());
}

std::vector<int> flow(const SoftState& state, WorkerPool& pool, SoftModel& model)
{
    const linalg::Parts parts{static_cast<int>(model.elements.size()), kElementsPerPart};
    std::vector<std::vector<int>> flowed(static_cast<std::size_t>(parts.count()));
    pool.run(parts.count(), [&](int part) {
        for (int e = parts[part].begin; e < parts[part].end; ++e) {
            FemElement& element = model.elements[static_cast<std::size_t>(e)];
            if (std::isfinite(element.yieldStress) && flowElement(model, state, static_cast<std::size_t>(e), element))
                flowed[static_cast<std::size_t>(part)].push_back(e);
        }
    });
    std::vector<int> all;
    for (const std::vector<int>& each : flowed) all.insert(all.end(), each.begin(), each.end());
    model.patched = model.patched || !all.empty();
    return all;
}

} // namespace filasofia::engine
