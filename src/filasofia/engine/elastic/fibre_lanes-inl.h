// Families of fibres (fibre.h) in lanes. Compiled once per target (Highway's foreach_target), which is why the guard is
// unusual.
#if defined(FILASOFIA_ENGINE_FIBRE_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_ENGINE_FIBRE_LANES_INL_H
#undef FILASOFIA_ENGINE_FIBRE_LANES_INL_H
#else
#define FILASOFIA_ENGINE_FIBRE_LANES_INL_H
#endif

#include "filasofia/engine/elastic/fibre_response-inl.h"
#include "filasofia/engine/elastic/law_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {

/// A symmetric 3 x 3 matrix times the edges: out_k = sum of m_kj e_j.
HWY_INLINE void timesEdges(const V (&m)[6], const V3 (&e)[3], V3 (&out)[3])
{
    constexpr int kEntry[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    for (int k = 0; k < 3; ++k) {
        const V a = m[kEntry[k][0]], b = m[kEntry[k][1]], c = m[kEntry[k][2]];
        out[k] = {sumOfProducts(a, e[0].x, b, e[1].x, c, e[2].x), sumOfProducts(a, e[0].y, b, e[1].y, c, e[2].y),
                  sumOfProducts(a, e[0].z, b, e[1].z, c, e[2].z)};
    }
}

/// FibreTangent of sixteen elements.
struct FibreLanes {
    V turning[6];
    V3 along[3];

    static HWY_INLINE FibreLanes load(const FibreTangentBlock& block, std::size_t part)
    {
        FibreLanes lanes;
        for (int k = 0; k < 6; ++k) lanes.turning[k] = hn::Load(Lanes(), block.turning[k] + part);
        loadGradients(block.along, part, lanes.along);
        return lanes;
    }
    HWY_INLINE void store(FibreTangentBlock& block, std::size_t part) const
    {
        for (int k = 0; k < 6; ++k) hn::Store(turning[k], Lanes(), block.turning[k] + part);
        storeRows(along, block.along, part);
    }
    HWY_INLINE void addTimes(const V3 (&edges)[3], V3 (&out)[3]) const
    {
        V3 turned[3];
        timesEdges(turning, edges, turned);
        const V longer = hn::Add(dot(along[0], edges[0]), hn::Add(dot(along[1], edges[1]), dot(along[2], edges[2])));
        for (int k = 0; k < 3; ++k) out[k] = out[k] + turned[k] + longer * along[k];
    }
    HWY_INLINE void addDiagonal(DiagonalLanes& to) const
    {
        const FourVectors all(along);
        V turned[4];
        diagonalOfEdges(turning, turned);
        for (int k = 0; k < 4; ++k) to.add(k, turned[k], lane(1.0f), all.v[k]);
    }
};

/// Adds the forces of a family on nodes 1, 2, 3, times the weight of forces, and returns its tangent. S g_k is the sum
/// of the edges times g_j . H g_k, and H : C is the sum of their products with the edges.
HWY_INLINE FibreLanes lineariseFibres(const physics::FibreFamily& family, const FibreBlock& block, std::size_t part,
                                      const LaneElement& at, const BlockWeights& weights, V3 (&forces)[3])
{
    const Lanes d;
    const V zero = hn::Zero(d), volume = hn::Load(d, block.volume + part);
    const auto present = hn::Gt(volume, zero);
    FibreLanes tangent;
    for (int k = 0; k < 6; ++k) tangent.turning[k] = hn::Load(d, block.structure[k] + part);
    V3 s[3];
    timesEdges(tangent.turning, at.edges, s);
    const V square = hn::Add(dot(s[0], at.edges[0]), hn::Add(dot(s[1], at.edges[1]), dot(s[2], at.edges[2])));
    const V strain = hn::IfThenElseZero(present, hn::Sub(square, lane(1.0f)));
    const FibreResponse<Lane> w =
        fibreResponse(Lane(family.stiffness), Lane(family.exponent), Lane(family.activeStress), Lane(strain));
    const V slope = twice(w.slope.v), force = hn::Mul(hn::Mul(volume, at.force), slope);
    for (int k = 0; k < 3; ++k) forces[k] = forces[k] + force * s[k];
    const V weight = hn::Mul(volume, lane(weights.fibreStiffness));
    const V turning = hn::Mul(hn::Mul(weight, lane(weights.fibreTurning)), slope);
    const V root = hn::Sqrt(hn::Mul(weight, hn::Mul(lane(4.0f), w.curvature.v)));
    for (V& each : tangent.turning) each = hn::Mul(turning, each);
    for (int k = 0; k < 3; ++k) tangent.along[k] = root * s[k];
    return tangent;
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
