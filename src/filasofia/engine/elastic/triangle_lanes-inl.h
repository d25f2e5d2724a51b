// One triangle per lane: what the vectorised loops over a shell share. Compiled once per target (Highway's
// foreach_target), which is why the guard is unusual.
#if defined(FILASOFIA_ENGINE_TRIANGLE_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_ENGINE_TRIANGLE_LANES_INL_H
#undef FILASOFIA_ENGINE_TRIANGLE_LANES_INL_H
#else
#define FILASOFIA_ENGINE_TRIANGLE_LANES_INL_H
#endif

#include "filasofia/engine/elastic/element_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {
using linalg::HWY_NAMESPACE::storeGroup;

/// The direction of a vector; zero if it has none.
HWY_INLINE V3 unit(V3 a)
{
    const Lanes d;
    const V size = hn::Sqrt(dot(a, a)), one = hn::Set(d, 1.0f);
    const auto some = hn::Gt(size, hn::Set(d, 1e-18f));
    return hn::IfThenElseZero(some, hn::Div(one, hn::IfThenElse(some, size, one))) * a;
}

/// A symmetric matrix, given by its entries xx xy xz yy yz zz, times a vector.
HWY_INLINE V3 symmetricProduct(const V (&m)[6], V3 a)
{
    return {dot({m[0], m[1], m[2]}, a), dot({m[1], m[3], m[4]}, a), dot({m[2], m[4], m[5]}, a)};
}

/// Two unit vectors, across each other.
struct Frame {
    V3 first, second;
};
HWY_INLINE Frame loadFrame(const float (&frame)[6][kBlock], std::size_t part)
{
    const Lanes d;
    return {{hn::Load(d, frame[0] + part), hn::Load(d, frame[1] + part), hn::Load(d, frame[2] + part)},
            {hn::Load(d, frame[3] + part), hn::Load(d, frame[4] + part), hn::Load(d, frame[5] + part)}};
}

/// One of the four forms of a quaternion, each good if its own component is large; the lanes where it is larger than
/// the best so far take it.
HWY_INLINE void takeLarger(V size, const Q4& form, V& best, Q4& q)
{
    const auto larger = hn::Gt(size, best);
    best = hn::IfThenElse(larger, size, best);
    q = {hn::IfThenElse(larger, form.x, q.x), hn::IfThenElse(larger, form.y, q.y), hn::IfThenElse(larger, form.z, q.z),
         hn::IfThenElse(larger, form.w, q.w)};
}

/// The unit quaternion of a rotation. If the matrix is none, as of a flat triangle, the result is still finite.
HWY_INLINE Q4 quaternionOf(const M3& r)
{
    const Lanes d;
    const V one = hn::Set(d, 1.0f);
    const V a = r.m[0][0], b = r.m[1][1], c = r.m[2][2];
    const V yz = hn::Sub(r.m[2][1], r.m[1][2]), zx = hn::Sub(r.m[0][2], r.m[2][0]), xy = hn::Sub(r.m[1][0], r.m[0][1]);
    const V sx = hn::Add(r.m[2][1], r.m[1][2]), sy = hn::Add(r.m[0][2], r.m[2][0]), sz = hn::Add(r.m[1][0], r.m[0][1]);
    const V w = hn::Add(one, hn::Add(a, hn::Add(b, c))), x = hn::Add(one, hn::Sub(a, hn::Add(b, c)));
    const V y = hn::Add(one, hn::Sub(b, hn::Add(a, c))), z = hn::Add(one, hn::Sub(c, hn::Add(a, b)));
    V best = w;
    Q4 q{yz, zx, xy, w};
    takeLarger(x, {x, sz, sy, yz}, best, q);
    takeLarger(y, {sz, y, sx, zx}, best, q);
    takeLarger(z, {sy, sx, z, xy}, best, q);
    const V size = hn::Sqrt(hn::MulAdd(q.w, q.w, dot({q.x, q.y, q.z}, {q.x, q.y, q.z})));
    const V inverse = hn::Div(one, hn::Max(size, hn::Set(d, 1e-6f)));
    return {hn::Mul(q.x, inverse), hn::Mul(q.y, inverse), hn::Mul(q.z, inverse), hn::Mul(q.w, inverse)};
}

/// The rotation that takes a triangle's frame at rest to the present one, given by its first edge and its normal.
HWY_INLINE Q4 rotationBetween(const Frame& rest, V3 edge, V3 normal)
{
    const V3 first = unit(edge), second = cross(normal, first), across = cross(rest.first, rest.second);
    M3 r;
    const auto row = [&](V a, V b, V c, V(&out)[3]) HWY_ATTR {
        out[0] = sumOfProducts(a, rest.first.x, b, rest.second.x, c, across.x);
        out[1] = sumOfProducts(a, rest.first.y, b, rest.second.y, c, across.y);
        out[2] = sumOfProducts(a, rest.first.z, b, rest.second.z, c, across.z);
    };
    row(first.x, second.x, normal.x, r.m[0]);
    row(first.y, second.y, normal.y, r.m[1]);
    row(first.z, second.z, normal.z, r.m[2]);
    return quaternionOf(r);
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
