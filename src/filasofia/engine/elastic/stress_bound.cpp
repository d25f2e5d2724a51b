#include "filasofia/engine/elastic/stress_bound.h"

#include "filasofia/linalg/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filasofia/engine/elastic/stress_bound.cpp"
#include <hwy/foreach_target.h>

#include "filasofia/engine/elastic/element_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {

HWY_INLINE V sizeOf(V3 a) { return hn::Add(hn::Abs(a.x), hn::Add(hn::Abs(a.y), hn::Abs(a.z))); }
HWY_INLINE V largestOf(V3 a) { return hn::Max(hn::Abs(a.x), hn::Max(hn::Abs(a.y), hn::Abs(a.z))); }

/// A bound on the rounding errors of the Frobenius norms of F and R. With the unit roundoff u = 2^-24, coordinates up
/// to X and the sum S of the gradients' sizes, the error of an entry of F is at most 12 u X times its column's part of
/// S: positions and gradients are rounded, then differences, products and sums. That is 21 u X S for all entries; R
/// adds less than 48 u.
HWY_INLINE V roundingOf(const float* HWY_RESTRICT x, const ElementBlock& element, std::size_t part, const V3 (&g)[3])
{
    const Lanes d;
    constexpr float kUnit = 5.9604645e-8f;
    V far = hn::Zero(d);
    for (int k = 0; k < 4; ++k) far = hn::Max(far, largestOf(gatherNodes(x, element.nodes[k] + part)));
    const V gradients = hn::Add(sizeOf(g[0]), hn::Add(sizeOf(g[1]), sizeOf(g[2])));
    return hn::MulAdd(hn::Set(d, 32.0f * kUnit), hn::Mul(far, gradients), hn::Set(d, 64.0f * kUnit));
}

HWY_ATTR void findStressedBlocks(const PlacedElements& body, StressLimit limit, std::uint16_t* HWY_RESTRICT stressed,
                                 linalg::Blocks blocks)
{
    const ElementBlock* HWY_RESTRICT elements = body.elements.data();
    const ElementRotations* HWY_RESTRICT rotations = body.rotations.data();
    const float* HWY_RESTRICT x = body.x.data();
    const Lanes d;
    const V one = hn::Set(d, 1.0f);
    // 1e-3 more for the relative rounding errors: those of the norms, of quantities computed from them, and of the unit
    // quaternions.
    const V shear = hn::Set(d, 1.001f * 2.0f * limit.mu), bulk = hn::Set(d, 1.001f * 1.7320509f * limit.lambda);
    for (int block = blocks.begin; block < blocks.end; ++block) {
        std::uint32_t bits = 0;
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            const ElementBlock& element = elements[block];
            V3 edges[3], g[3];
            loadEdges(x, element.nodes, part, edges);
            loadGradients(element.gradients, part, g);
            const M3 f = gradientOf(edges, g);
            const ElementRotations& turn = rotations[block];
            const M3 r = matrixOf({hn::Load(d, turn.x + part), hn::Load(d, turn.y + part), hn::Load(d, turn.z + part),
                                   hn::Load(d, turn.w + part)});
            const V rounding = roundingOf(x, element, part, g);

            V strain2 = hn::Zero(d), stretch = hn::Set(d, -3.0f);
            for (int k = 0; k < 9; ++k) {
                const V e = hn::Sub(f.m[k / 3][k % 3], r.m[k / 3][k % 3]);
                strain2 = hn::MulAdd(e, e, strain2);
                stretch = hn::MulAdd(r.m[k / 3][k % 3], f.m[k / 3][k % 3], stretch);
            }
            const V strain = hn::Add(hn::Sqrt(strain2), rounding);
            const V volumetric = hn::MulAdd(hn::Set(d, 8.0f), rounding, hn::Abs(stretch));
            const V det = hn::NegMulAdd(hn::Set(d, 16.0f), rounding, determinant(f)); // less its rounding error
            const V stress = hn::Mul(hn::MulAdd(shear, strain, hn::Mul(bulk, volumetric)), hn::Add(one, strain));
            // Beyond a strain of 1 these multiples do not bound the rounding errors. A NaN counts as stressed.
            const auto far = hn::And(hn::And(hn::Lt(strain, one), hn::Gt(det, hn::Set(d, 0.1f))),
                                     hn::Lt(stress, hn::Mul(hn::Set(d, limit.most), det)));
            std::uint8_t mask[8] = {};
            hn::StoreMaskBits(d, hn::Not(far), mask);
            bits |= (mask[0] | static_cast<std::uint32_t>(mask[1]) << 8) << part;
        }
        stressed[block] = static_cast<std::uint16_t>(bits);
    }
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace filasofia::engine {

HWY_EXPORT(findStressedBlocks);

void findStressed(const PlacedElements& body, StressLimit limit, std::span<std::uint16_t> stressed,
                  linalg::Blocks blocks)
{
    HWY_DYNAMIC_DISPATCH(findStressedBlocks)(body, limit, stressed.data(), blocks);
}

} // namespace filasofia::engine
#endif
