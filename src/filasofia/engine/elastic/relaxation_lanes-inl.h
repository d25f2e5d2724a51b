// Relaxation (relaxation.h) in lanes. Compiled once per target (Highway's foreach_target), which is why the guard is
// unusual.
#if defined(FILASOFIA_ENGINE_RELAXATION_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_ENGINE_RELAXATION_LANES_INL_H
#undef FILASOFIA_ENGINE_RELAXATION_LANES_INL_H
#else
#define FILASOFIA_ENGINE_RELAXATION_LANES_INL_H
#endif

#include "filasofia/engine/elastic/law_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {

/// The edges to nodes 1, 2, 3 at rest, times the determinant of the gradients: e_k . g_j = det for j = k, else 0.
HWY_INLINE V restEdges(const V3 (&g)[3], V3 (&edges)[3])
{
    for (int k = 0; k < 3; ++k) edges[k] = cross(g[(k + 1) % 3], g[(k + 2) % 3]);
    return dot(g[0], edges[0]);
}

/// Replaces the forces of a law on nodes 1, 2, 3, times the weight of forces, by those of updateRelaxation(), and
/// updates the relaxation. The law's stress follows from its forces: V P is the sum of f_k e_k^T with the edges at
/// rest.
HWY_INLINE void relax(const RelaxationStep& step, const LaneElement& at, std::size_t part, ElementRelaxation& state,
                      V3 (&forces)[3])
{
    const Lanes d;
    V3 edges[3], turned[3];
    const V det = restEdges(at.g, edges);
    const V size = hn::Mul(at.mu, at.force);
    // Lanes that fill up the last block have no stiffness.
    const V scale = hn::IfThenElseZero(hn::Gt(size, hn::Zero(d)), hn::Div(lane(1.0f), hn::Mul(size, det)));
    for (int k = 0; k < 3; ++k) turned[k] = timesTransposed(at.r, forces[k]);
    V stress[kSymmetric]; // of R^T P / mu, which is symmetric
    stress[0] = sumOfProducts(turned[0].x, edges[0].x, turned[1].x, edges[1].x, turned[2].x, edges[2].x);
    stress[1] = sumOfProducts(turned[0].x, edges[0].y, turned[1].x, edges[1].y, turned[2].x, edges[2].y);
    stress[2] = sumOfProducts(turned[0].x, edges[0].z, turned[1].x, edges[1].z, turned[2].x, edges[2].z);
    stress[3] = sumOfProducts(turned[0].y, edges[0].y, turned[1].y, edges[1].y, turned[2].y, edges[2].y);
    stress[4] = sumOfProducts(turned[0].y, edges[0].z, turned[1].y, edges[1].z, turned[2].y, edges[2].z);
    stress[5] = sumOfProducts(turned[0].z, edges[0].z, turned[1].z, edges[1].z, turned[2].z, edges[2].z);
    V total[kSymmetric];
    for (std::size_t k = 0; k < kSymmetric; ++k) {
        const V now = hn::Mul(scale, stress[k]);
        const V change = hn::Sub(now, hn::Load(d, state.stress[k] + part));
        total[k] = hn::Mul(lane(static_cast<float>(step.present)), now);
        for (std::size_t i = 0; i < step.terms; ++i) {
            const V decayed =
                hn::Mul(lane(static_cast<float>(step.past.decay[i])), hn::Load(d, state.terms[i][k] + part));
            const V term = hn::MulAdd(lane(static_cast<float>(step.past.gain[i])), change, decayed);
            hn::Store(term, d, state.terms[i][k] + part);
            total[k] = hn::MulAdd(lane(static_cast<float>(step.ahead.decay[i])), term, total[k]);
        }
        hn::Store(now, d, state.stress[k] + part);
    }
    const M3 t{{{total[0], total[1], total[2]}, {total[1], total[3], total[4]}, {total[2], total[4], total[5]}}};
    for (int k = 0; k < 3; ++k) forces[k] = size * times(at.r, times(t, at.g[k]));
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
