// What the vectorised loops give a law, and what they take from it. Compiled once per target (Highway's
// foreach_target), which is why the guard is unusual.
#if defined(FILASOFIA_ENGINE_LAW_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_ENGINE_LAW_LANES_INL_H
#undef FILASOFIA_ENGINE_LAW_LANES_INL_H
#else
#define FILASOFIA_ENGINE_LAW_LANES_INL_H
#endif

#include "filasofia/engine/elastic/element_blocks.h"
#include "filasofia/engine/elastic/rotation_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {

/// Elements side by side, at the start of a step.
///
/// A law has a function linearise(law, element, forces). It writes the internal forces on nodes 1, 2, 3, times the
/// weight of forces, and returns the tangent, times the weight of the stiffness: a type with a Block that holds it in
/// memory, load(), store(), times(), which multiplies the edges of a vector, and addDiagonal().
struct LaneElement {
    V3 edges[3];                 ///< from node 0 to nodes 1, 2, 3 [m]
    V3 g[3];                     ///< their shape gradients [1/m]
    M3 f, r;                     ///< the deformation gradient and its rotation
    V mu, ratio;                 ///< mu times volume and scale; lambda / mu
    V force, stiffness, turning; ///< BlockWeights
};

/// The blocks on the diagonal of an element's matrix, one per node, symmetric.
struct DiagonalLanes {
    V3 own[4], mixed[4]; ///< xx yy zz, yz zx xy
    HWY_INLINE DiagonalLanes()
    {
        const V zero = hn::Zero(Lanes());
        for (int k = 0; k < 4; ++k) own[k] = mixed[k] = {zero, zero, zero};
    }
    /// Adds a I + b v v^T.
    HWY_INLINE void add(int node, V a, V b, V3 v)
    {
        const V3 bv = b * v;
        own[node] = own[node] + V3{hn::MulAdd(bv.x, v.x, a), hn::MulAdd(bv.y, v.y, a), hn::MulAdd(bv.z, v.z, a)};
        mixed[node] = mixed[node] + V3{hn::Mul(bv.y, v.z), hn::Mul(bv.z, v.x), hn::Mul(bv.x, v.y)};
    }
};
/// What nodes 1, 2, 3 have, and node 0 as minus their sum: gradients, and all that is linear in them.
struct FourVectors {
    V3 v[4];
    HWY_INLINE explicit FourVectors(const V3 (&three)[3])
        : v{negative(three[0] + three[1] + three[2]), three[0], three[1], three[2]}
    {
    }
};
/// The diagonal of a symmetric matrix over the edges 00 01 02 11 12 22, for nodes 0 to 3.
HWY_INLINE void diagonalOfEdges(const V (&m)[6], V (&out)[4])
{
    out[1] = m[0];
    out[2] = m[3];
    out[3] = m[5];
    out[0] = hn::Add(hn::Add(m[0], hn::Add(m[3], m[5])), twice(hn::Add(m[1], hn::Add(m[2], m[4]))));
}

HWY_INLINE V lane(float value) { return hn::Set(Lanes(), value); }
HWY_INLINE void storeRows(const V3 (&from)[3], float (&to)[9][kBlock], std::size_t part)
{
    const Lanes d;
    for (int k = 0; k < 3; ++k) {
        hn::Store(from[k].x, d, to[3 * k] + part);
        hn::Store(from[k].y, d, to[3 * k + 1] + part);
        hn::Store(from[k].z, d, to[3 * k + 2] + part);
    }
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
