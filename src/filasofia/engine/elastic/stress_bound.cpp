#include "filasofia/engine/elastic/stress_bound.h"

#include "filasofia/linalg/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filasofia/engine/elastic/stress_bound.cpp"
#include <hwy/foreach_target.h>

#include "filasofia/engine/elastic/element_lanes-inl.h"
#include "filasofia/engine/elastic/laws/all-inl.h"
#include "filasofia/engine/elastic/stretch_modes-inl.h"

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

/// Beyond a strain of 1, and below a tenth of the volume, the multiples of `rounding` do not bound the errors: such an
/// element counts as stressed.
HWY_INLINE hn::Mask<Lanes> isFar(V stress, V limit, V strain, V det)
{
    const Lanes d;
    return hn::And(hn::And(hn::Lt(strain, hn::Set(d, 1.0f)), hn::Gt(det, hn::Set(d, 0.1f))),
                   hn::Lt(stress, hn::Mul(limit, det)));
}

/// The lanes of elements that are certainly below the limit. A NaN is not.
HWY_INLINE hn::Mask<Lanes> belowLimit(const physics::Corotational&, const M3& f, const M3& r, V, V rounding,
                                      const StressLimit& limit)
{
    const Lanes d;
    const V one = hn::Set(d, 1.0f);
    // 1e-3 more for the relative rounding errors: those of the norms, of quantities computed from them, and of the unit
    // quaternions.
    const V shear = hn::Set(d, 1.001f * 2.0f * limit.mu), bulk = hn::Set(d, 1.001f * 1.7320509f * limit.lambda);
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
    return isFar(stress, hn::Set(d, limit.most), strain, det);
}

/// The stretches follow from F^T F: they do not depend on a rotation that is a step old.
HWY_INLINE hn::Mask<Lanes> belowLimit(const physics::ElasticLaw& law, const M3& f, const M3&, V ratio, V rounding,
                                      const StressLimit& limit)
{
    const Lanes d;
    const M3 square = transposeTimes(f, f);
    Lane a[3][3], v[3][3], s[3], most = 0.0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) a[i][j] = Lane(square.m[i][j]);
    diagonalise(a, v);
    for (int i = 0; i < 3; ++i) {
        s[i] = squareRoot(larger(a[i][i], Lane(0.0)));
        most = larger(most, s[i]);
    }
    const StretchResponse<Lane> w = responseOf(law, s, Lane(ratio));
    Lane stress = w.d[0] * s[0], steepness = 0.0;
    for (int i = 0; i < 3; ++i) {
        stress = larger(stress, w.d[i] * s[i]);
        steepness = steepness + magnitude(w.d[i]);
        for (int j = 0; j < 3; ++j) steepness = steepness + magnitude(w.h[i][j]);
    }
    const V strain = hn::Add(hn::Sub(most.v, hn::Set(d, 1.0f)), rounding);
    const V det = hn::NegMulAdd(hn::Set(d, 16.0f), rounding, determinant(f));
    const Lane slack = Lane(16.0) * Lane(rounding) * steepness * (Lane(1.0) + most);
    const V bound = hn::Mul(hn::Set(d, 1.001f * limit.mu), (stress + slack).v);
    return isFar(bound, hn::Set(d, limit.most), strain, det);
}

template <class Law> HWY_ATTR void findStressedOf(const Law& law, const PlacedElements& body, const StressLimit& limit,
                                                  std::uint16_t* HWY_RESTRICT stressed, linalg::Blocks blocks)
{
    const ElementBlock* HWY_RESTRICT elements = body.elements.data();
    const ElementRotations* HWY_RESTRICT rotations = body.rotations.data();
    const float* HWY_RESTRICT x = body.x.data();
    const Lanes d;
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
            const V rounding = roundingOf(x, element, part, g), ratio = hn::Load(d, element.ratio + part);
            bits |= bitsOf(hn::Not(belowLimit(law, f, r, ratio, rounding, limit))) << part;
        }
        stressed[block] = static_cast<std::uint16_t>(bits);
    }
}

HWY_ATTR void findStressedBlocks(const PlacedElements& body, const StressLimit& limit, std::uint16_t* stressed,
                                 linalg::Blocks blocks)
{
    if (const auto* corotational = std::get_if<physics::Corotational>(&limit.law))
        findStressedOf(*corotational, body, limit, stressed, blocks);
    else
        findStressedOf(limit.law, body, limit, stressed, blocks);
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace filasofia::engine {

HWY_EXPORT(findStressedBlocks);

void findStressed(const PlacedElements& body, const StressLimit& limit, std::span<std::uint16_t> stressed,
                  linalg::Blocks blocks)
{
    HWY_DYNAMIC_DISPATCH(findStressedBlocks)(body, limit, stressed.data(), blocks);
}

} // namespace filasofia::engine
#endif
