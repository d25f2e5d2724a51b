// The corotational law (corotational.h) in lanes. Compiled once per target (Highway's foreach_target), which is why the
// guard is unusual.
#if defined(FILASOFIA_ENGINE_COROTATIONAL_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_ENGINE_COROTATIONAL_LANES_INL_H
#undef FILASOFIA_ENGINE_COROTATIONAL_LANES_INL_H
#else
#define FILASOFIA_ENGINE_COROTATIONAL_LANES_INL_H
#endif

#include "filasofia/engine/elastic/corotational.h"
#include "filasofia/engine/elastic/law_lanes-inl.h"
#include "filasofia/physics/elastic_law.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {

/// geometricStiffness() / mu (corotational.h) for the lanes in tension.
HWY_INLINE V geometricRatio(const M3& f, const M3& r, V tension, hn::Mask<Lanes> tense)
{
    const Lanes d;
    const V one = hn::Set(d, 1.0f), two = hn::Set(d, 2.0f);
    M3 s = transposeTimes(r, f);
    const V size = hn::Add(hn::Add(s.m[0][0], s.m[1][1]), s.m[2][2]);
    const V scale = hn::Div(one, hn::IfThenElse(tense, size, one)); // avoids overflow in the products of floats
    for (int k = 0; k < 9; ++k) s.m[k / 3][k % 3] = hn::Mul(scale, s.m[k / 3][k % 3]);
    const V least = hn::Max(hn::Set(d, static_cast<float>(kFlattest)), stretchSums(s).det);
    return hn::IfThenElseZero(tense, hn::Add(one, hn::Mul(scale, hn::Div(hn::Sub(tension, two), least))));
}

/// WarpedTangent of sixteen elements.
struct WarpedLanes {
    using Block = WarpedBlock;
    V3 b[3]; ///< gradients, rotated, and scaled by the root of the shear stiffness
    V ratio, turning;

    static HWY_INLINE WarpedLanes load(const Block& block, std::size_t part)
    {
        WarpedLanes lanes;
        loadGradients(block.gradients, part, lanes.b);
        lanes.ratio = hn::Load(Lanes(), block.ratio + part);
        lanes.turning = hn::Load(Lanes(), block.turning + part);
        return lanes;
    }
    HWY_INLINE void store(Block& block, std::size_t part) const
    {
        storeRows(b, block.gradients, part);
        hn::Store(ratio, Lanes(), block.ratio + part);
        hn::Store(turning, Lanes(), block.turning + part);
    }
    HWY_INLINE void times(const V3 (&edges)[3], V3 (&out)[3]) const
    {
        const M3 h = gradientOf(edges, b); // with respect to the rotated and scaled rest shape
        const V volumetric = hn::Mul(ratio, hn::Add(hn::Add(h.m[0][0], h.m[1][1]), h.m[2][2]));
        const V xx = hn::Add(twice(h.m[0][0]), volumetric), yy = hn::Add(twice(h.m[1][1]), volumetric);
        const V zz = hn::Add(twice(h.m[2][2]), volumetric);
        const V more = hn::Add(hn::Set(Lanes(), 1.0f), turning), less = hn::Sub(hn::Set(Lanes(), 1.0f), turning);
        const auto entry = [&](V ahead, V behind) HWY_ATTR { return hn::MulAdd(more, ahead, hn::Mul(less, behind)); };
        const V xy = entry(h.m[0][1], h.m[1][0]), yx = entry(h.m[1][0], h.m[0][1]);
        const V xz = entry(h.m[0][2], h.m[2][0]), zx = entry(h.m[2][0], h.m[0][2]);
        const V yz = entry(h.m[1][2], h.m[2][1]), zy = entry(h.m[2][1], h.m[1][2]);
        for (int k = 0; k < 3; ++k)
            out[k] = {dot({xx, xy, xz}, b[k]), dot({yx, yy, yz}, b[k]), dot({zx, zy, zz}, b[k])};
    }
};

HWY_INLINE WarpedLanes linearise(const physics::Corotational&, const LaneElement& at, V3 (&forces)[3])
{
    const Lanes d;
    const V two = lane(2.0f);
    // The first Piola-Kirchhoff stress P = 2 mu (F - R) + lambda (tr(R^T F) - 3) R puts -V P g_k on the nodes.
    // An inverted element resists shear only (lameAt in corotational.h).
    const auto inverted = hn::Lt(determinant(at.f), hn::Zero(d));
    const V ratio = hn::IfThenZeroElse(inverted, at.ratio);
    const V lambda = hn::Mul(ratio, at.mu);
    V stretch = lane(-3.0f);
    for (int k = 0; k < 9; ++k) stretch = hn::MulAdd(at.r.m[k / 3][k % 3], at.f.m[k / 3][k % 3], stretch);
    const V shear = hn::Mul(hn::Mul(two, at.mu), at.force), bulk = hn::Mul(hn::Mul(lambda, stretch), at.force);
    M3 stress;
    for (int k = 0; k < 9; ++k)
        stress.m[k / 3][k % 3] =
            hn::MulAdd(shear, hn::Sub(at.f.m[k / 3][k % 3], at.r.m[k / 3][k % 3]), hn::Mul(bulk, at.r.m[k / 3][k % 3]));
    for (int k = 0; k < 3; ++k) forces[k] = times(stress, at.g[k]);

    WarpedLanes tangent;
    tangent.ratio = ratio;
    const V tension = hn::Mul(ratio, stretch);
    const auto tense = hn::And(hn::Gt(tension, two), hn::Gt(stretch, lane(static_cast<float>(kTense))));
    tangent.turning = hn::Zero(d);
    if (!hn::AllFalse(d, tense)) tangent.turning = hn::Mul(at.turning, geometricRatio(at.f, at.r, tension, tense));
    const V root = hn::Sqrt(hn::Mul(at.mu, at.stiffness));
    for (int k = 0; k < 3; ++k) tangent.b[k] = root * times(at.r, at.g[k]);
    return tangent;
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
