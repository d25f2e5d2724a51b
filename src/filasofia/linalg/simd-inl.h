// Sixteen lanes on any instruction set. Highway's foreach_target compiles this file once per target, which is why its
// include guard is unusual.
#if defined(FILASOFIA_LINALG_SIMD_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_LINALG_SIMD_INL_H
#undef FILASOFIA_LINALG_SIMD_INL_H
#else
#define FILASOFIA_LINALG_SIMD_INL_H
#endif

#include "filasofia/linalg/node_array.h"
#include "filasofia/linalg/simd_targets.h"

#include <hwy/highway.h>

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace filasofia::linalg::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Nodes and elements are processed in blocks of sixteen. A machine with fewer lanes takes a block in two or four parts:
// every lane computes the same on every machine if no lane depends on another. Targets differ only in fused
// multiply-add: those that have it give the same bits.
using Lanes = hn::CappedTag<float, 16>;
using Four = hn::CappedTag<float, 4>;
using V = hn::Vec<Lanes>;
using V4 = hn::Vec<Four>;
constexpr std::size_t kLanes = hn::MaxLanes(Lanes());

struct V3 {
    V x, y, z;
};

/// Vectors of four floats from base + at[0], base + at[4], base + at[8] ..., one after another.
template <class D> HWY_INLINE hn::Vec<D> everyFourth(D d, const float* HWY_RESTRICT base, const int* HWY_RESTRICT at)
{
    if constexpr (hn::MaxLanes(D()) == 4) {
        return hn::Load(d, base + at[0]);
    } else {
        const hn::Half<D> half;
        return hn::Combine(d, everyFourth(half, base, at + hn::MaxLanes(D()) / 2), everyFourth(half, base, at));
    }
}

/// The lower and the upper half of each 128 bits of a, followed by that of b.
HWY_INLINE V lowerHalves(V a, V b)
{
    const hn::RepartitionToWide<Lanes> wide;
    return hn::BitCast(Lanes(), hn::InterleaveLower(wide, hn::BitCast(wide, a), hn::BitCast(wide, b)));
}
HWY_INLINE V upperHalves(V a, V b)
{
    const hn::RepartitionToWide<Lanes> wide;
    return hn::BitCast(Lanes(), hn::InterleaveUpper(wide, hn::BitCast(wide, a), hn::BitCast(wide, b)));
}

/// The vectors x y z _ at base + at[lane], transposed into one vector per component.
HWY_INLINE V3 gatherNodes(const float* HWY_RESTRICT base, const int* HWY_RESTRICT at)
{
    const Lanes d;
    const V r0 = everyFourth(d, base, at), r1 = everyFourth(d, base, at + 1);
    const V r2 = everyFourth(d, base, at + 2), r3 = everyFourth(d, base, at + 3);
    const V xy01 = hn::InterleaveLower(d, r0, r1), z01 = hn::InterleaveUpper(d, r0, r1);
    const V xy23 = hn::InterleaveLower(d, r2, r3), z23 = hn::InterleaveUpper(d, r2, r3);
    return {lowerHalves(xy01, xy23), upperHalves(xy01, xy23), lowerHalves(z01, z23)};
}

/// One vector of four floats per lane: those of lanes 0, 4, 8 ..., those of lanes 1, 5, 9 ..., and so on.
struct Transposed {
    V of0, of1, of2, of3;
};
HWY_INLINE Transposed transposed(V x, V y, V z, V w)
{
    const Lanes d;
    const V xy01 = hn::InterleaveLower(d, x, y), xy23 = hn::InterleaveUpper(d, x, y);
    const V zw01 = hn::InterleaveLower(d, z, w), zw23 = hn::InterleaveUpper(d, z, w);
    return {lowerHalves(xy01, zw01), upperHalves(xy01, zw01), lowerHalves(xy23, zw23), upperHalves(xy23, zw23)};
}

/// Stores one vector per lane into a group of sixteen; that of lane l lies at laneOffset(l) (node_array.h).
HWY_INLINE void storeGroup(V3 v, V w, float* HWY_RESTRICT group, std::size_t part)
{
    const Lanes d;
    const Transposed t = transposed(v.x, v.y, v.z, w);
    hn::Store(t.of0, d, group + part);
    hn::Store(t.of1, d, group + 16 + part);
    hn::Store(t.of2, d, group + 32 + part);
    hn::Store(t.of3, d, group + 48 + part);
}

/// Adds one vector per lane to those of a group, whose fourth numbers stay as they are.
HWY_INLINE void addGroup(V3 v, float* HWY_RESTRICT group, std::size_t part)
{
    const Lanes d;
    const Transposed t = transposed(v.x, v.y, v.z, hn::Zero(d));
    const auto add = [&](V more, float* at) HWY_ATTR { hn::Store(hn::Add(hn::Load(d, at), more), d, at); };
    add(t.of0, group + part);
    add(t.of1, group + 16 + part);
    add(t.of2, group + 32 + part);
    add(t.of3, group + 48 + part);
}

/// Consecutive nodes of a block, from node `part` on.
HWY_INLINE V3 loadNodes(const float* HWY_RESTRICT nodes, std::size_t part)
{
    static constexpr int kAt[16] = {0, 4, 8, 12, 16, 20, 24, 28, 32, 36, 40, 44, 48, 52, 56, 60};
    return gatherNodes(nodes, kAt + part);
}

template <class D> HWY_INLINE void storeEveryFourth(D d, hn::Vec<D> v, float* HWY_RESTRICT base)
{
    if constexpr (hn::MaxLanes(D()) == 4) {
        hn::Store(v, d, base);
    } else {
        const hn::Half<D> half;
        storeEveryFourth(half, hn::LowerHalf(half, v), base);
        storeEveryFourth(half, hn::UpperHalf(half, v), base + 2 * hn::MaxLanes(D()));
    }
}

HWY_INLINE void storeNodes(V3 v, float* HWY_RESTRICT nodes, std::size_t part)
{
    const Lanes d;
    const Transposed t = transposed(v.x, v.y, v.z, hn::Zero(d));
    storeEveryFourth(d, t.of0, nodes + 4 * part);
    storeEveryFourth(d, t.of1, nodes + 4 * part + 4);
    storeEveryFourth(d, t.of2, nodes + 4 * part + 8);
    storeEveryFourth(d, t.of3, nodes + 4 * part + 12);
}

/// a * b + c * d + e * f, in this order.
HWY_INLINE V sumOfProducts(V a, V b, V c, V d, V e, V f) { return hn::MulAdd(e, f, hn::MulAdd(c, d, hn::Mul(a, b))); }

/// The sum of the vectors of the corners around one node.
HWY_INLINE V4 gathered(const int* HWY_RESTRICT place, const int* HWY_RESTRICT end, const float* HWY_RESTRICT corners)
{
    const Four d;
    V4 even = hn::Zero(d), odd = hn::Zero(d);
    for (; place + 1 < end; place += 2) {
        even = hn::Add(even, hn::Load(d, corners + place[0]));
        odd = hn::Add(odd, hn::Load(d, corners + place[1]));
    }
    if (place < end) even = hn::Add(even, hn::Load(d, corners + *place));
    return hn::Add(even, odd);
}

/// Sixteen sums side by side, four nodes to a row: sixteen lanes on every target.
struct LaneSums {
    alignas(64) float lanes[kBlock];

    [[nodiscard]] double total() const
    {
        double sum = 0.0;
        for (float each : lanes) sum += static_cast<double>(each);
        return sum;
    }
};

} // namespace filasofia::linalg::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
