#include "filasofia/sofa/tear_stress.h"

#include "filasofia/engine/elastic/law.h"
#include "filasofia/engine/rupture/stress.h"
#include "filasofia/engine/rupture/tet_shape.h"
#include "filasofia/math/polar.h"

#include <algorithm>
#include <cmath>

namespace filasofia::sofaengine {
namespace {

Mat3 edgesOf(const std::array<Vec3, 4>& corners)
{
    return Mat3::columns(corners[1] - corners[0], corners[2] - corners[0], corners[3] - corners[0]);
}

Mat3 tissueStress(const SoftPlan& plan, const physics::ElasticLaw& law, std::size_t t,
                  const std::vector<Vec3>& positions)
{
    const Mat3 f = gradientOf(plan, t, positions);
    const engine::Lame material = engine::lame(plan.youngModulus[t], plan.poissonRatio[t]);
    return engine::cauchyStress(law, material, {f, toMat3(polarRotation(f, {}))});
}

/// How many elements share each spring.
std::vector<int> usesOf(const SoftPlan& plan)
{
    std::vector<int> uses(plan.edges.size());
    for (const geometry::Tetrahedron& t : plan.mesh.tetrahedra)
        for (const auto& [i, j] : geometry::kTetrahedronEdges) {
            const std::array<int, 2> edge{std::min(t[i], t[j]), std::max(t[i], t[j])};
            ++uses[static_cast<std::size_t>(std::ranges::lower_bound(plan.edges, edge) - plan.edges.begin())];
        }
    return uses;
}

Mat3 springStress(const SoftPlan& plan, double stiffness, const std::vector<int>& uses, std::size_t t,
                  const std::vector<Vec3>& positions)
{
    const geometry::Tetrahedron& nodes = plan.mesh.tetrahedra[t];
    std::array<double, 6> tensions{};
    for (std::size_t k = 0; k < 6; ++k) {
        const int a = nodes[geometry::kTetrahedronEdges[k][0]], b = nodes[geometry::kTetrahedronEdges[k][1]];
        const std::array<int, 2> edge{std::min(a, b), std::max(a, b)};
        const auto spring = static_cast<std::size_t>(std::ranges::lower_bound(plan.edges, edge) - plan.edges.begin());
        const double rest = distance(plan.mesh.nodes[at(a)], plan.mesh.nodes[at(b)]);
        tensions[k] = stiffness * (distance(positions[at(a)], positions[at(b)]) - rest) / uses[spring];
    }
    return engine::virialStress(engine::cornersOf(nodes, positions), tensions);
}

} // namespace

Mat3 gradientOf(const SoftPlan& plan, std::size_t element, const std::vector<Vec3>& positions)
{
    const geometry::Tetrahedron& nodes = plan.mesh.tetrahedra[element];
    return edgesOf(engine::cornersOf(nodes, positions)) * inverse(edgesOf(engine::cornersOf(nodes, plan.mesh.nodes)));
}

double tearingThreshold(const SoftPlan& plan)
{
    double least = physics::kNever;
    for (const double each : plan.tearing) least = std::min(least, each);
    return least;
}

std::vector<Mat3> tearingStresses(const SoftPlan& plan, const std::vector<Vec3>& positions,
                                  const std::vector<std::uint8_t>& held)
{
    const double threshold = tearingThreshold(plan);
    const auto* springs = std::get_if<physics::MassSpringMaterial>(&plan.def.material);
    const std::vector<int> uses = springs ? usesOf(plan) : std::vector<int>{};
    std::vector<Mat3> stresses(plan.mesh.tetrahedra.size());
    bool above = false;
    for (std::size_t t = 0; t < stresses.size(); ++t) {
        if (std::ranges::all_of(plan.mesh.tetrahedra[t], [&](int node) { return held[at(node)] != 0; })) continue;
        const Mat3 stress =
            springs ? springStress(plan, springs->stiffness, uses, t, positions)
                    : tissueStress(plan, std::get<physics::FemMaterial>(plan.def.material).law, t, positions);
        stresses[t] = threshold / plan.tearing[t] * stress;
        above = above || engine::principalStressBound(stresses[t]) > threshold;
    }
    if (!above) stresses.clear();
    return stresses;
}

} // namespace filasofia::sofaengine
