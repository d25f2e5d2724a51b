// One element per lane: the helpers that the vectorised loops over elements share. Compiled once per target (Highway's
// foreach_target), which is why the guard is unusual.
#if defined(FILASOFIA_ENGINE_ELEMENT_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_ENGINE_ELEMENT_LANES_INL_H
#undef FILASOFIA_ENGINE_ELEMENT_LANES_INL_H
#else
#define FILASOFIA_ENGINE_ELEMENT_LANES_INL_H
#endif

#include "filasofia/linalg/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using linalg::kBlock;
using linalg::HWY_NAMESPACE::gatherNodes;
using linalg::HWY_NAMESPACE::kLanes;
using linalg::HWY_NAMESPACE::Lanes;
using linalg::HWY_NAMESPACE::sumOfProducts;
using linalg::HWY_NAMESPACE::V;
using linalg::HWY_NAMESPACE::V3;

struct M3 {
    V m[3][3]; ///< by rows
};
struct Q4 {
    V x, y, z, w;
};

HWY_INLINE V3 operator-(V3 a, V3 b) { return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)}; }
HWY_INLINE V3 operator+(V3 a, V3 b) { return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)}; }
HWY_INLINE V3 negative(V3 a) { return {hn::Neg(a.x), hn::Neg(a.y), hn::Neg(a.z)}; }
HWY_INLINE V3 operator*(V s, V3 a) { return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)}; }
HWY_INLINE V dot(V3 a, V3 b) { return sumOfProducts(a.x, b.x, a.y, b.y, a.z, b.z); }
HWY_INLINE V3 cross(V3 a, V3 b)
{
    return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
            hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}

HWY_INLINE V3 times(const M3& a, V3 b)
{
    return {dot({a.m[0][0], a.m[0][1], a.m[0][2]}, b), dot({a.m[1][0], a.m[1][1], a.m[1][2]}, b),
            dot({a.m[2][0], a.m[2][1], a.m[2][2]}, b)};
}
HWY_INLINE V3 timesTransposed(const M3& a, V3 b) ///< a^T b
{
    return {dot({a.m[0][0], a.m[1][0], a.m[2][0]}, b), dot({a.m[0][1], a.m[1][1], a.m[2][1]}, b),
            dot({a.m[0][2], a.m[1][2], a.m[2][2]}, b)};
}
HWY_INLINE M3 transposeTimes(const M3& a, const M3& b)
{
    M3 product;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            product.m[i][j] = sumOfProducts(a.m[0][i], b.m[0][j], a.m[1][i], b.m[1][j], a.m[2][i], b.m[2][j]);
    return product;
}
/// One bit per lane, the first the lowest.
HWY_INLINE std::uint32_t bitsOf(hn::Mask<Lanes> mask)
{
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(Lanes(), mask, bytes);
    return bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8;
}
HWY_INLINE V twice(V a) { return hn::Add(a, a); }

HWY_INLINE M3 matrixOf(const Q4& q)
{
    const Lanes d;
    const V one = hn::Set(d, 1.0f), x2 = twice(q.x), y2 = twice(q.y), z2 = twice(q.z);
    const V xx = hn::Mul(q.x, x2), yy = hn::Mul(q.y, y2), zz = hn::Mul(q.z, z2);
    const V xy = hn::Mul(q.x, y2), xz = hn::Mul(q.x, z2), yz = hn::Mul(q.y, z2);
    const V wx = hn::Mul(q.w, x2), wy = hn::Mul(q.w, y2), wz = hn::Mul(q.w, z2);
    return {{{hn::Sub(one, hn::Add(yy, zz)), hn::Sub(xy, wz), hn::Add(xz, wy)},
             {hn::Add(xy, wz), hn::Sub(one, hn::Add(xx, zz)), hn::Sub(yz, wx)},
             {hn::Sub(xz, wy), hn::Add(yz, wx), hn::Sub(one, hn::Add(xx, yy))}}};
}

/// sum of e_k g_k^T over the edges to nodes 1, 2, 3: the deformation gradient if e are edges of positions, its rate if
/// they are edges of velocities.
HWY_INLINE M3 gradientOf(const V3 (&e)[3], const V3 (&g)[3])
{
    M3 f;
    const auto row = [&](V a, V b, V c, V(&out)[3]) HWY_ATTR {
        out[0] = sumOfProducts(a, g[0].x, b, g[1].x, c, g[2].x);
        out[1] = sumOfProducts(a, g[0].y, b, g[1].y, c, g[2].y);
        out[2] = sumOfProducts(a, g[0].z, b, g[1].z, c, g[2].z);
    };
    row(e[0].x, e[1].x, e[2].x, f.m[0]);
    row(e[0].y, e[1].y, e[2].y, f.m[1]);
    row(e[0].z, e[1].z, e[2].z, f.m[2]);
    return f;
}

HWY_INLINE V determinant(const M3& f)
{
    const auto minor = [&](int i, int j)
                           HWY_ATTR { return hn::MulSub(f.m[1][i], f.m[2][j], hn::Mul(f.m[1][j], f.m[2][i])); };
    return sumOfProducts(f.m[0][0], minor(1, 2), f.m[0][1], minor(2, 0), f.m[0][2], minor(0, 1));
}

HWY_INLINE void loadGradients(const float (&gradients)[9][kBlock], std::size_t part, V3 (&g)[3])
{
    const Lanes d;
    for (int k = 0; k < 3; ++k)
        g[k] = {hn::Load(d, gradients[3 * k] + part), hn::Load(d, gradients[3 * k + 1] + part),
                hn::Load(d, gradients[3 * k + 2] + part)};
}

HWY_INLINE void loadEdges(const float* HWY_RESTRICT nodes, const int (&at)[4][kBlock], std::size_t part, V3 (&e)[3])
{
    const V3 origin = gatherNodes(nodes, at[0] + part);
    for (int k = 0; k < 3; ++k) e[k] = gatherNodes(nodes, at[k + 1] + part) - origin;
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
