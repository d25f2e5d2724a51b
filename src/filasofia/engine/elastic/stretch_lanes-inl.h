// The laws of the principal stretches (stretch_law.h) in lanes. Compiled once per target (Highway's foreach_target),
// which is why the guard is unusual.
#if defined(FILASOFIA_ENGINE_STRETCH_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_ENGINE_STRETCH_LANES_INL_H
#undef FILASOFIA_ENGINE_STRETCH_LANES_INL_H
#else
#define FILASOFIA_ENGINE_STRETCH_LANES_INL_H
#endif

#include "filasofia/engine/elastic/law_lanes-inl.h"
#include "filasofia/engine/elastic/laws/all-inl.h"
#include "filasofia/engine/elastic/stretch_modes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {

HWY_INLINE M3 product(const M3& a, const M3& b)
{
    M3 out;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            out.m[i][j] = sumOfProducts(a.m[i][0], b.m[0][j], a.m[i][1], b.m[1][j], a.m[i][2], b.m[2][j]);
    return out;
}

/// StretchTangent of sixteen elements.
struct StretchLanes {
    using Block = StretchBlock;
    M3 u;    ///< axes of the stretches in the world
    V3 b[3]; ///< gradients along the axes at rest, scaled by the root of mu
    StretchModes<Lane> modes;

    static HWY_INLINE StretchLanes load(const Block& block, std::size_t part)
    {
        const Lanes d;
        StretchLanes lanes;
        loadGradients(block.gradients, part, lanes.b);
        for (int k = 0; k < 9; ++k) lanes.u.m[k / 3][k % 3] = hn::Load(d, block.axes[k] + part);
        for (int i = 0, at = 0; i < 3; ++i)
            for (int j = i; j < 3; ++j, ++at)
                lanes.modes.a[i][j] = lanes.modes.a[j][i] = Lane(hn::Load(d, block.stretch[at] + part));
        for (int k = 0; k < 3; ++k) {
            lanes.modes.ahead[k] = Lane(hn::Load(d, block.ahead[k] + part));
            lanes.modes.across[k] = Lane(hn::Load(d, block.across[k] + part));
        }
        return lanes;
    }
    HWY_INLINE void store(Block& block, std::size_t part) const
    {
        const Lanes d;
        storeRows(b, block.gradients, part);
        for (int k = 0; k < 9; ++k) hn::Store(u.m[k / 3][k % 3], d, block.axes[k] + part);
        for (int i = 0, at = 0; i < 3; ++i)
            for (int j = i; j < 3; ++j, ++at) hn::Store(modes.a[i][j].v, d, block.stretch[at] + part);
        for (int k = 0; k < 3; ++k) {
            hn::Store(modes.ahead[k].v, d, block.ahead[k] + part);
            hn::Store(modes.across[k].v, d, block.across[k] + part);
        }
    }
    HWY_INLINE void times(const V3 (&edges)[3], V3 (&out)[3]) const
    {
        const M3 inAxes = transposeTimes(u, gradientOf(edges, b));
        Lane h[3][3], p[3][3];
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) h[i][j] = Lane(inAxes.m[i][j]);
        modesTimes(modes, h, p);
        M3 stress;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) stress.m[i][j] = p[i][j].v;
        for (int k = 0; k < 3; ++k) out[k] = HWY_NAMESPACE::times(u, HWY_NAMESPACE::times(stress, b[k]));
    }
    /// u M u^T, where M is along the axes: M_ii = a_ii b_i^2 + the sum of ahead b_j^2 of both others, and
    /// M_ij = (a_ij + across) b_i b_j.
    HWY_INLINE void addDiagonal(DiagonalLanes& to) const
    {
        const FourVectors all(b);
        for (int node = 0; node < 4; ++node) {
            const V g[3] = {all.v[node].x, all.v[node].y, all.v[node].z};
            V m[3][3];
            for (int i = 0; i < 3; ++i) m[i][i] = hn::Mul(modes.a[i][i].v, hn::Mul(g[i], g[i]));
            for (int k = 0; k < 3; ++k) { // the pair of axes that is across axis k
                const int i = (k + 1) % 3, j = (k + 2) % 3;
                m[i][i] = hn::MulAdd(modes.ahead[k].v, hn::Mul(g[j], g[j]), m[i][i]);
                m[j][j] = hn::MulAdd(modes.ahead[k].v, hn::Mul(g[i], g[i]), m[j][j]);
                m[i][j] = m[j][i] = hn::Mul(hn::Add(modes.a[i][j].v, modes.across[k].v), hn::Mul(g[i], g[j]));
            }
            M3 half; // u M
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j)
                    half.m[i][j] = sumOfProducts(u.m[i][0], m[0][j], u.m[i][1], m[1][j], u.m[i][2], m[2][j]);
            const auto entry = [&](int i, int j) HWY_ATTR {
                return sumOfProducts(half.m[i][0], u.m[j][0], half.m[i][1], u.m[j][1], half.m[i][2], u.m[j][2]);
            };
            to.own[node] = to.own[node] + V3{entry(0, 0), entry(1, 1), entry(2, 2)};
            to.mixed[node] = to.mixed[node] + V3{entry(1, 2), entry(2, 0), entry(0, 1)};
        }
    }
};

HWY_INLINE StretchLanes linearise(const physics::ElasticLaw& law, const LaneElement& at, V3 (&forces)[3])
{
    const M3 sym = transposeTimes(at.r, at.f);
    Lane s[3][3];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) s[i][j] = Lane(sym.m[i][j]);
    const Stretches<Lane> axes = stretchesOf(s);
    const StretchResponse<Lane> w = responseOf(law, axes.s, Lane(at.ratio));
    M3 v;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) v.m[i][j] = axes.v[i][j].v;

    StretchLanes tangent;
    tangent.u = product(at.r, v);
    tangent.modes = modesOf(w, axes.s, Lane(at.turning));
    const V scaled = hn::Mul(at.mu, at.force), root = hn::Sqrt(hn::Mul(at.mu, at.stiffness));
    for (int k = 0; k < 3; ++k) { // P = u diag(dW/ds) v^T
        const V3 g = timesTransposed(v, at.g[k]);
        forces[k] = scaled * times(tangent.u, {hn::Mul(w.d[0].v, g.x), hn::Mul(w.d[1].v, g.y), hn::Mul(w.d[2].v, g.z)});
        tangent.b[k] = root * g;
    }
    return tangent;
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
