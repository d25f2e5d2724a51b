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
/// memory, load(), store(), and times(), which multiplies the edges of a vector.
struct LaneElement {
    V3 edges[3];                 ///< from node 0 to nodes 1, 2, 3 [m]
    V3 g[3];                     ///< their shape gradients [1/m]
    M3 f, r;                     ///< the deformation gradient and its rotation
    V mu, ratio;                 ///< mu times volume and scale; lambda / mu
    V force, stiffness, turning; ///< BlockWeights
};

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
