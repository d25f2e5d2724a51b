#include "filasofia/linalg/rotation_kernels.h"

#include "filasofia/linalg/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filasofia/linalg/rotation_kernels.cpp"
#include <hwy/foreach_target.h>

#include "filasofia/linalg/simd-inl.h"

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace filasofia::linalg::HWY_NAMESPACE {

HWY_ATTR void warpAndSmoothBlocks(const RotationBlock* HWY_RESTRICT rotations,
                                  const SymmetricBlock* HWY_RESTRICT inverseDiagonal, const float* HWY_RESTRICT r,
                                  float* HWY_RESTRICT s, float* HWY_RESTRICT w, Blocks blocks)
{
    const Lanes d;
    for (int b = blocks.begin; b < blocks.end; ++b)
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            const auto m = [&](int k) HWY_ATTR { return hn::Load(d, rotations[b].m[k] + part); };
            const auto i = [&](int k) HWY_ATTR { return hn::Load(d, inverseDiagonal[b].m[k] + part); };
            const V3 u = loadNodes(r + 64ul * b, part);
            const V3 t{sumOfProducts(m(0), u.x, m(3), u.y, m(6), u.z), sumOfProducts(m(1), u.x, m(4), u.y, m(7), u.z),
                       sumOfProducts(m(2), u.x, m(5), u.y, m(8), u.z)};
            storeNodes(t, s + 64ul * b, part);
            storeNodes({sumOfProducts(i(0), t.x, i(1), t.y, i(2), t.z), sumOfProducts(i(1), t.x, i(3), t.y, i(4), t.z),
                        sumOfProducts(i(2), t.x, i(4), t.y, i(5), t.z)},
                       w + 64ul * b, part);
        }
}

/// The inverse of a symmetric matrix xx xy xz yy yz zz. Where rounding leaves none, the matrix counts as its trace.
HWY_INLINE void invertSymmetric(const V (&m)[6], V (&out)[6])
{
    const Lanes d;
    const auto minor = [&](V a, V b, V c, V e) HWY_ATTR { return hn::MulSub(a, b, hn::Mul(c, e)); };
    const V c[6] = {minor(m[3], m[5], m[4], m[4]), minor(m[2], m[4], m[1], m[5]), minor(m[1], m[4], m[2], m[3]),
                    minor(m[0], m[5], m[2], m[2]), minor(m[1], m[2], m[0], m[4]), minor(m[0], m[3], m[1], m[1])};
    const V det = sumOfProducts(m[0], c[0], m[1], c[1], m[2], c[2]);
    const auto good = hn::And(hn::Gt(det, hn::Zero(d)), hn::And(hn::Gt(c[0], hn::Zero(d)), hn::Gt(m[0], hn::Zero(d))));
    const V one = hn::Set(d, 1.0f), perDet = hn::Div(one, hn::IfThenElse(good, det, one));
    const V plain = hn::Div(one, hn::Add(m[0], hn::Add(m[3], m[5])));
    constexpr bool kDiagonal[6] = {true, false, false, true, false, true};
    for (int k = 0; k < 6; ++k)
        out[k] = hn::IfThenElse(good, hn::Mul(perDet, c[k]), kDiagonal[k] ? plain : hn::Zero(d));
}

HWY_ATTR void invertDiagonalBlocks(const DiagonalTerms& terms, const RotationBlock* HWY_RESTRICT rotations,
                                   SymmetricBlock* HWY_RESTRICT inverse, Blocks blocks)
{
    const ListRange* HWY_RESTRICT ranges = terms.nodes.gather.ranges.data();
    const int* HWY_RESTRICT places = terms.nodes.gather.values.data();
    const Lanes d;
    const Four four;
    alignas(64) float own[64], mixed[64];
    for (int b = blocks.begin; b < blocks.end; ++b) {
        for (std::size_t node = 0; node < kBlock; ++node) {
            const std::size_t i = 16ul * static_cast<std::size_t>(b) + node;
            const int *place = places + ranges[i].begin, *end = places + ranges[i].end;
            const float more = terms.nodes.massWeight * terms.nodes.masses[i] + terms.nodes.extra[i];
            hn::Store(hn::Add(hn::Set(four, more), gathered(place, end, terms.nodes.corners.data())), four,
                      own + 4 * node);
            hn::Store(gathered(place, end, terms.mixed.data()), four, mixed + 4 * node);
        }
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            const auto m = [&](int k) HWY_ATTR { return hn::Load(d, rotations[b].m[k] + part); };
            const V3 a = loadNodes(own, part), c = loadNodes(mixed, part); // xx yy zz, yz zx xy
            V turned[3][3];                                                // the matrix times R
            for (int k = 0; k < 3; ++k) {
                turned[0][k] = sumOfProducts(a.x, m(k), c.z, m(3 + k), c.y, m(6 + k));
                turned[1][k] = sumOfProducts(c.z, m(k), a.y, m(3 + k), c.x, m(6 + k));
                turned[2][k] = sumOfProducts(c.y, m(k), c.x, m(3 + k), a.z, m(6 + k));
            }
            V rest[6], out[6]; // R^T that
            for (int i = 0, at = 0; i < 3; ++i)
                for (int k = i; k < 3; ++k, ++at)
                    rest[at] = sumOfProducts(m(i), turned[0][k], m(3 + i), turned[1][k], m(6 + i), turned[2][k]);
            invertSymmetric(rest, out);
            for (int k = 0; k < 6; ++k) hn::Store(out[k], d, inverse[b].m[k] + part);
        }
    }
}

HWY_ATTR void turnBlocks(const RotationBlock* HWY_RESTRICT turns, float* HWY_RESTRICT vectors, Blocks blocks)
{
    const Lanes d;
    for (int b = blocks.begin; b < blocks.end; ++b)
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            const auto m = [&](int k) HWY_ATTR { return hn::Load(d, turns[b].m[k] + part); };
            const V3 u = loadNodes(vectors + 64ul * b, part);
            storeNodes({sumOfProducts(m(0), u.x, m(1), u.y, m(2), u.z), sumOfProducts(m(3), u.x, m(4), u.y, m(5), u.z),
                        sumOfProducts(m(6), u.x, m(7), u.y, m(8), u.z)},
                       vectors + 64ul * b, part);
        }
}

/// The sum with what one node follows of the coarse nodes: sum + (P x_c)_i
HWY_INLINE V4 addProlonged(V4 sum, const InterpolationBlock& from, int node, const float* HWY_RESTRICT values)
{
    const Four four;
    for (int k = 0; k < 4; ++k) // the fourth float belongs to a neighbour and is never used
        sum = hn::MulAdd(hn::Set(four, from.weights[node][k]), hn::LoadU(four, values + from.at[node][k]), sum);
    return sum;
}

HWY_ATTR double prolongAndUnwarpBlocks(const RotationBlock* HWY_RESTRICT rotations, const CoarseCorrection& correction,
                                       const float* HWY_RESTRICT w, const float* HWY_RESTRICT r, float* HWY_RESTRICT z,
                                       Blocks blocks)
{
    const bool coarse = !correction.interpolation.empty();
    const InterpolationBlock* HWY_RESTRICT from = correction.interpolation.data();
    const float* HWY_RESTRICT values = correction.values.data();
    const Lanes d;
    const Four four;
    LaneSums sums{};
    alignas(64) float rest[64];
    for (int b = blocks.begin; b < blocks.end; ++b) {
        const float* source = w + 64ul * b;
        if (coarse) {
            for (int node = 0; node < kBlock; ++node) {
                const V4 own = hn::Load(four, source + 4 * node);
                hn::Store(addProlonged(own, from[b], node, values), four, rest + 4 * node);
            }
            source = rest;
        }
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            const auto m = [&](int k) HWY_ATTR { return hn::Load(d, rotations[b].m[k] + part); };
            const V3 t = loadNodes(source, part), u = loadNodes(r + 64ul * b, part);
            const V3 rotated{sumOfProducts(m(0), t.x, m(1), t.y, m(2), t.z),
                             sumOfProducts(m(3), t.x, m(4), t.y, m(5), t.z),
                             sumOfProducts(m(6), t.x, m(7), t.y, m(8), t.z)};
            storeNodes(rotated, z + 64ul * b, part);
            const V product = sumOfProducts(rotated.x, u.x, rotated.y, u.y, rotated.z, u.z);
            hn::Store(hn::Add(hn::Load(d, sums.lanes + part), product), d, sums.lanes + part);
        }
    }
    return sums.total();
}

HWY_ATTR void prolongByMassBlocks(const InterpolationBlock* HWY_RESTRICT from, const float* HWY_RESTRICT values,
                                  const float* HWY_RESTRICT masses, float* HWY_RESTRICT y, Blocks blocks)
{
    const Four four;
    for (int b = blocks.begin; b < blocks.end; ++b)
        for (int node = 0; node < kBlock; ++node) {
            const V4 sum = addProlonged(hn::Zero(four), from[b], node, values);
            float* at = y + 64ul * b + 4ul * node;
            hn::Store(hn::Mul(hn::Set(four, masses[16ul * b + node]), sum), four, at);
            at[3] = 0.0f;
        }
}

/// Where the quaternion of an element lies, given where one of its corners lies: a block of sixteen elements has one
/// group of quaternions and four groups of corners.
HWY_INLINE int quaternionAt(int corner) { return (corner >> 8 << 6) | (corner & 63); }

/// The sum with every quaternion on the side of the first one: q and -q are the same rotation, and in the plain sum
/// they cancel.
HWY_INLINE void sumOnOneSide(const int* place, const int* end, const float* quaternions, float* sum)
{
    float first[4] = {};
    for (int i = 0; i < 4; ++i) sum[i] = 0.0f;
    for (const int* at = place; at < end; ++at) {
        const float* q = quaternions + quaternionAt(*at);
        if (at == place) std::copy(q, q + 4, first);
        const float side = q[0] * first[0] + q[1] * first[1] + q[2] * first[2] + q[3] * first[3];
        for (int i = 0; i < 4; ++i) sum[i] += side < 0.0f ? -q[i] : q[i];
    }
}

HWY_ATTR void averageRotationBlocks(const ListRange* HWY_RESTRICT ranges, const int* HWY_RESTRICT places,
                                    const float* HWY_RESTRICT quaternions, RotationBlock* HWY_RESTRICT rotations,
                                    Blocks blocks)
{
    const Lanes d;
    const Four four;
    alignas(64) float sums[64];
    for (int b = blocks.begin; b < blocks.end; ++b) {
        for (int node = 0; node < kBlock; ++node) {
            const ListRange range = ranges[16 * b + node];
            const int *place = places + range.begin, *end = places + range.end;
            V4 even = hn::Zero(four), odd = hn::Zero(four);
            const int* at = place;
            for (; at + 1 < end; at += 2) {
                even = hn::Add(even, hn::Load(four, quaternions + quaternionAt(at[0])));
                odd = hn::Add(odd, hn::Load(four, quaternions + quaternionAt(at[1])));
            }
            if (at < end) even = hn::Add(even, hn::Load(four, quaternions + quaternionAt(*at)));
            float* sum = sums + 4 * node;
            hn::Store(hn::Add(even, odd), four, sum);
            const float size = sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2] + sum[3] * sum[3];
            const auto count = static_cast<float>(end - place);
            if (size < 0.25f * count * count) sumOnOneSide(place, end, quaternions, sum);
            if (place == end) sum[3] = 1.0f;
        }
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            const V3 v = loadNodes(sums, part);
            alignas(64) float real[kLanes];
            for (std::size_t l = 0; l < kLanes; ++l) real[l] = sums[4 * (part + l) + 3];
            const V w = hn::Load(d, real), one = hn::Set(d, 1.0f);
            const V size = hn::MulAdd(w, w, sumOfProducts(v.x, v.x, v.y, v.y, v.z, v.z));
            const V twice = hn::Div(hn::Set(d, 2.0f), size); // for products of the unit quaternion
            const V x = hn::Mul(v.x, twice), y = hn::Mul(v.y, twice), z = hn::Mul(v.z, twice);
            const V xx = hn::Mul(x, v.x), yy = hn::Mul(y, v.y), zz = hn::Mul(z, v.z);
            const V xy = hn::Mul(x, v.y), xz = hn::Mul(x, v.z), yz = hn::Mul(y, v.z);
            const V wx = hn::Mul(x, w), wy = hn::Mul(y, w), wz = hn::Mul(z, w);
            const V m[9] = {hn::Sub(one, hn::Add(yy, zz)), hn::Sub(xy, wz), hn::Add(xz, wy), hn::Add(xy, wz),
                            hn::Sub(one, hn::Add(xx, zz)), hn::Sub(yz, wx), hn::Sub(xz, wy), hn::Add(yz, wx),
                            hn::Sub(one, hn::Add(xx, yy))};
            for (int k = 0; k < 9; ++k) hn::Store(m[k], d, rotations[b].m[k] + part);
        }
    }
}

} // namespace filasofia::linalg::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace filasofia::linalg {

HWY_EXPORT(warpAndSmoothBlocks);
HWY_EXPORT(invertDiagonalBlocks);
HWY_EXPORT(turnBlocks);
HWY_EXPORT(prolongAndUnwarpBlocks);
HWY_EXPORT(prolongByMassBlocks);
HWY_EXPORT(averageRotationBlocks);

void warpAndSmooth(const std::vector<RotationBlock>& rotations, const std::vector<SymmetricBlock>& inverseDiagonal,
                   const NodeArray& r, NodeArray& s, NodeArray& w, Blocks blocks)
{
    HWY_DYNAMIC_DISPATCH(warpAndSmoothBlocks)
    (rotations.data(), inverseDiagonal.data(), r.data(), s.data(), w.data(), blocks);
}

void invertDiagonal(const DiagonalTerms& terms, const std::vector<RotationBlock>& rotations,
                    std::vector<SymmetricBlock>& inverse, Blocks blocks)
{
    HWY_DYNAMIC_DISPATCH(invertDiagonalBlocks)(terms, rotations.data(), inverse.data(), blocks);
}

void turnBoth(const std::vector<RotationBlock>& turns, NodeArray& s, NodeArray& w, Blocks blocks)
{
    for (NodeArray* each : {&s, &w}) HWY_DYNAMIC_DISPATCH(turnBlocks)(turns.data(), each->data(), blocks);
}

double prolongAndUnwarp(const std::vector<RotationBlock>& rotations, const CoarseCorrection& coarse, const NodeArray& w,
                        const NodeArray& r, NodeArray& z, Blocks blocks)
{
    return HWY_DYNAMIC_DISPATCH(prolongAndUnwarpBlocks)(rotations.data(), coarse, w.data(), r.data(), z.data(), blocks);
}

void prolongByMass(const CoarseCorrection& coarse, std::span<const float> masses, NodeArray& y, Blocks blocks)
{
    HWY_DYNAMIC_DISPATCH(prolongByMassBlocks)
    (coarse.interpolation.data(), coarse.values.data(), masses.data(), y.data(), blocks);
}

void averageRotations(const Gather& gather, std::span<const float> quaternions, std::vector<RotationBlock>& rotations,
                      Blocks blocks)
{
    HWY_DYNAMIC_DISPATCH(averageRotationBlocks)
    (gather.ranges.data(), gather.values.data(), quaternions.data(), rotations.data(), blocks);
}

} // namespace filasofia::linalg
#endif
