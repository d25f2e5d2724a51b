#include "filasofia/linalg/node_kernels.h"

#include "filasofia/linalg/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filasofia/linalg/node_kernels.cpp"
#include <hwy/foreach_target.h>

#include "filasofia/linalg/simd-inl.h"

#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace filasofia::linalg::HWY_NAMESPACE {

// Sixteen sums side by side, four nodes to a row, for sixteen lanes on every target.
struct LaneSums {
    alignas(64) float lanes[kBlock];

    [[nodiscard]] double total() const
    {
        double sum = 0.0;
        for (float each : lanes) sum += static_cast<double>(each);
        return sum;
    }
};

HWY_ATTR double dotBlocks(const float* HWY_RESTRICT a, const float* HWY_RESTRICT b, Blocks blocks)
{
    const Lanes d;
    LaneSums sums;
    for (std::size_t part = 0; part < kBlock; part += kLanes) {
        V sum = hn::Zero(d);
        for (std::size_t i = 64ul * blocks.begin + part; i < 64ul * blocks.end; i += kBlock)
            sum = hn::MulAdd(hn::Load(d, a + i), hn::Load(d, b + i), sum);
        hn::Store(sum, d, sums.lanes + part);
    }
    return sums.total();
}

HWY_ATTR void turnBlocks(const float* HWY_RESTRICT z, float beta, float* HWY_RESTRICT p, Blocks blocks)
{
    const Lanes d;
    const V b = hn::Set(d, beta);
    for (std::size_t i = 64ul * blocks.begin; i < 64ul * blocks.end; i += kLanes)
        hn::Store(hn::MulAdd(b, hn::Load(d, p + i), hn::Load(d, z + i)), d, p + i);
}

HWY_ATTR double descendBlocks(float alpha, const float* HWY_RESTRICT p, const float* HWY_RESTRICT q,
                              float* HWY_RESTRICT x, float* HWY_RESTRICT r, Blocks blocks)
{
    const Lanes d;
    const V a = hn::Set(d, alpha);
    LaneSums sums;
    for (std::size_t part = 0; part < kBlock; part += kLanes) {
        V sum = hn::Zero(d);
        for (std::size_t i = 64ul * blocks.begin + part; i < 64ul * blocks.end; i += kBlock) {
            hn::Store(hn::MulAdd(a, hn::Load(d, p + i), hn::Load(d, x + i)), d, x + i);
            const V residual = hn::NegMulAdd(a, hn::Load(d, q + i), hn::Load(d, r + i));
            hn::Store(residual, d, r + i);
            sum = hn::MulAdd(residual, residual, sum);
        }
        hn::Store(sum, d, sums.lanes + part);
    }
    return sums.total();
}

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

HWY_ATTR double prolongAndUnwarpBlocks(const RotationBlock* HWY_RESTRICT rotations,
                                       const InterpolationBlock* HWY_RESTRICT from, const float* HWY_RESTRICT coarse,
                                       const float* HWY_RESTRICT w, const float* HWY_RESTRICT r, float* HWY_RESTRICT z,
                                       Blocks blocks)
{
    const Lanes d;
    const Four four;
    LaneSums sums{};
    alignas(64) float rest[64];
    for (int b = blocks.begin; b < blocks.end; ++b) {
        const float* source = w + 64ul * b;
        if (from) {
            for (int node = 0; node < kBlock; ++node) {
                V4 sum = hn::Load(four, source + 4 * node);
                for (int k = 0; k < 4; ++k) // the fourth float is a neighbour's: nobody looks at it
                    sum = hn::MulAdd(hn::Set(four, from[b].weights[node][k]),
                                     hn::LoadU(four, coarse + from[b].at[node][k]), sum);
                hn::Store(sum, four, rest + 4 * node);
            }
            source = rest;
        }
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            const auto m = [&](int k) HWY_ATTR { return hn::Load(d, rotations[b].m[k] + part); };
            const V3 t = loadNodes(source, part), u = loadNodes(r + 64ul * b, part);
            const V3 turned{sumOfProducts(m(0), t.x, m(1), t.y, m(2), t.z),
                            sumOfProducts(m(3), t.x, m(4), t.y, m(5), t.z),
                            sumOfProducts(m(6), t.x, m(7), t.y, m(8), t.z)};
            storeNodes(turned, z + 64ul * b, part);
            const V product = sumOfProducts(turned.x, u.x, turned.y, u.y, turned.z, u.z);
            hn::Store(hn::Add(hn::Load(d, sums.lanes + part), product), d, sums.lanes + part);
        }
    }
    return sums.total();
}

HWY_ATTR void restrictNodes(const int* HWY_RESTRICT starts, const int* HWY_RESTRICT nodes,
                            const float* HWY_RESTRICT weights, const float* HWY_RESTRICT s, float* HWY_RESTRICT coarse,
                            int begin, int end)
{
    const Four d;
    alignas(16) float sum[4];
    for (int c = begin; c < end; ++c) {
        V4 even = hn::Zero(d), odd = hn::Zero(d);
        int k = starts[c];
        for (; k + 1 < starts[c + 1]; k += 2) {
            even = hn::MulAdd(hn::Set(d, weights[k]), hn::Load(d, s + 4ul * nodes[k]), even);
            odd = hn::MulAdd(hn::Set(d, weights[k + 1]), hn::Load(d, s + 4ul * nodes[k + 1]), odd);
        }
        if (k < starts[c + 1]) even = hn::MulAdd(hn::Set(d, weights[k]), hn::Load(d, s + 4ul * nodes[k]), even);
        hn::Store(hn::Add(even, odd), d, sum);
        for (int i = 0; i < 3; ++i) coarse[3 * c + i] = sum[i];
    }
}

HWY_ATTR void multiplyPanelRange(const PanelRow* HWY_RESTRICT panels, const float* HWY_RESTRICT x, int rows,
                                 float* HWY_RESTRICT y, int begin, int end)
{
    const Lanes d;
    for (int k = begin; k < end; ++k) {
        const PanelRow* HWY_RESTRICT row = panels + static_cast<std::ptrdiff_t>(k) * rows;
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            V s0 = hn::Zero(d), s1 = s0, s2 = s0, s3 = s0;
            for (int i = 0; i < rows; i += 4) { // rows come in fours
                s0 = hn::MulAdd(hn::Set(d, x[i]), hn::Load(d, row[i].values + part), s0);
                s1 = hn::MulAdd(hn::Set(d, x[i + 1]), hn::Load(d, row[i + 1].values + part), s1);
                s2 = hn::MulAdd(hn::Set(d, x[i + 2]), hn::Load(d, row[i + 2].values + part), s2);
                s3 = hn::MulAdd(hn::Set(d, x[i + 3]), hn::Load(d, row[i + 3].values + part), s3);
            }
            hn::StoreU(hn::Add(hn::Add(s0, s1), hn::Add(s2, s3)), d, y + 16ul * k + part);
        }
    }
}

/// The sum of the vectors of one node's corners.
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

template <bool forces> HWY_INLINE double gatherBlocks(const int* HWY_RESTRICT starts, const int* HWY_RESTRICT places,
                                                      const float* HWY_RESTRICT corners, float scale,
                                                      const float* HWY_RESTRICT masses, const float* HWY_RESTRICT extra,
                                                      const float* HWY_RESTRICT p, float* HWY_RESTRICT y, Blocks blocks)
{
    const Four d;
    LaneSums sums;
    V4 sum[4] = {hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    const V4 s = hn::Set(d, scale);
    for (std::size_t node = 16ul * blocks.begin; node < 16ul * blocks.end; node += 4)
        for (std::size_t k = 0; k < 4; ++k) {
            const std::size_t i = node + k;
            const V4 corner = gathered(places + starts[i], places + starts[i + 1], corners);
            const V4 diagonal = hn::MulAdd(s, hn::Set(d, masses[i]), hn::Set(d, extra[i]));
            const V4 direction = hn::Load(d, p + 4 * i);
            if constexpr (forces) {
                const V4 force = hn::NegMulAdd(diagonal, direction, hn::Add(hn::Load(d, y + 4 * i), corner));
                hn::Store(force, d, y + 4 * i);
                sum[k] = hn::MulAdd(force, force, sum[k]);
            } else {
                const V4 product = hn::MulAdd(diagonal, direction, corner);
                hn::Store(product, d, y + 4 * i);
                sum[k] = hn::MulAdd(product, direction, sum[k]);
            }
        }
    for (std::size_t k = 0; k < 4; ++k) hn::Store(sum[k], d, sums.lanes + 4 * k);
    return sums.total();
}

HWY_ATTR double gatherProduct(const int* starts, const int* places, const float* corners, float scale,
                              const float* masses, const float* extra, const float* p, float* y, Blocks blocks)
{
    return gatherBlocks<false>(starts, places, corners, scale, masses, extra, p, y, blocks);
}
HWY_ATTR double gatherForce(const int* starts, const int* places, const float* corners, float scale,
                            const float* masses, const float* extra, const float* p, float* y, Blocks blocks)
{
    return gatherBlocks<true>(starts, places, corners, scale, masses, extra, p, y, blocks);
}

HWY_ATTR StepWork stepWorkBlocks(const float* HWY_RESTRICT masses, const float* HWY_RESTRICT v,
                                 const float* HWY_RESTRICT dv, const float* HWY_RESTRICT r,
                                 const float* HWY_RESTRICT push, Blocks blocks)
{
    const Four d;
    LaneSums work, change, motion;
    V4 sums[3][4];
    for (auto& each : sums)
        for (V4& sum : each) sum = hn::Zero(d);
    for (std::size_t node = 16ul * blocks.begin; node < 16ul * blocks.end; node += 4)
        for (std::size_t k = 0; k < 4; ++k) {
            const std::size_t i = 4 * (node + k);
            const V4 mass = hn::Set(d, masses[node + k]), difference = hn::Load(d, dv + i);
            const V4 w = hn::Add(hn::Load(d, v + i), difference);
            sums[0][k] = hn::MulAdd(hn::Sub(hn::Load(d, r + i), hn::Load(d, push + i)), w, sums[0][k]);
            sums[1][k] = hn::MulAdd(hn::Mul(mass, difference), difference, sums[1][k]);
            sums[2][k] = hn::MulAdd(hn::Mul(mass, w), w, sums[2][k]);
        }
    for (std::size_t k = 0; k < 4; ++k) {
        hn::Store(sums[0][k], d, work.lanes + 4 * k);
        hn::Store(sums[1][k], d, change.lanes + 4 * k);
        hn::Store(sums[2][k], d, motion.lanes + 4 * k);
    }
    return {work.total(), change.total(), motion.total()};
}

/// Where the quaternion of the element lies whose corner lies at `corner`: one group for the four corners of a block.
HWY_INLINE int quaternionAt(int corner) { return (corner >> 8 << 6) | (corner & 63); }

/// Quaternions q and -q are the same rotation: where the plain sum cancels, all are turned to the side of the first.
HWY_INLINE void sumOfOneSide(const int* place, const int* end, const float* quaternions, float* sum)
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

HWY_ATTR void averageRotationBlocks(const int* HWY_RESTRICT starts, const int* HWY_RESTRICT places,
                                    const float* HWY_RESTRICT quaternions, RotationBlock* HWY_RESTRICT rotations,
                                    Blocks blocks)
{
    const Lanes d;
    const Four four;
    alignas(64) float sums[64];
    for (int b = blocks.begin; b < blocks.end; ++b) {
        for (int node = 0; node < kBlock; ++node) {
            const int *place = places + starts[16 * b + node], *end = places + starts[16 * b + node + 1];
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
            if (size < 0.25f * count * count) sumOfOneSide(place, end, quaternions, sum);
            if (place == end) sum[3] = 1.0f;
        }
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            const V3 v = loadNodes(sums, part);
            alignas(64) float real[kLanes];
            for (std::size_t l = 0; l < kLanes; ++l) real[l] = sums[4 * (part + l) + 3];
            const V w = hn::Load(d, real), one = hn::Set(d, 1.0f);
            const V size = hn::MulAdd(w, w, sumOfProducts(v.x, v.x, v.y, v.y, v.z, v.z));
            const V twice = hn::Div(hn::Set(d, 2.0f), size); // of the unit quaternion's products
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
#include "filasofia/core/error.h"

namespace filasofia::linalg {

HWY_EXPORT(dotBlocks);
HWY_EXPORT(turnBlocks);
HWY_EXPORT(descendBlocks);
HWY_EXPORT(warpAndSmoothBlocks);
HWY_EXPORT(prolongAndUnwarpBlocks);
HWY_EXPORT(restrictNodes);
HWY_EXPORT(multiplyPanelRange);
HWY_EXPORT(gatherProduct);
HWY_EXPORT(gatherForce);
HWY_EXPORT(stepWorkBlocks);
HWY_EXPORT(averageRotationBlocks);

double dot(const NodeArray& a, const NodeArray& b, Blocks blocks)
{
    return HWY_DYNAMIC_DISPATCH(dotBlocks)(a.data(), b.data(), blocks);
}

void turn(const NodeArray& z, float beta, NodeArray& p, Blocks blocks)
{
    HWY_DYNAMIC_DISPATCH(turnBlocks)(z.data(), beta, p.data(), blocks);
}

double descend(float alpha, const NodeArray& p, const NodeArray& q, NodeArray& x, NodeArray& r, Blocks blocks)
{
    return HWY_DYNAMIC_DISPATCH(descendBlocks)(alpha, p.data(), q.data(), x.data(), r.data(), blocks);
}

void warpAndSmooth(const std::vector<RotationBlock>& rotations, const std::vector<SymmetricBlock>& inverseDiagonal,
                   const NodeArray& r, NodeArray& s, NodeArray& w, Blocks blocks)
{
    HWY_DYNAMIC_DISPATCH(warpAndSmoothBlocks)
    (rotations.data(), inverseDiagonal.data(), r.data(), s.data(), w.data(), blocks);
}

double prolongAndUnwarp(const std::vector<RotationBlock>& rotations, const std::vector<InterpolationBlock>& from,
                        std::span<const float> coarse, const NodeArray& w, const NodeArray& r, NodeArray& z,
                        Blocks blocks)
{
    return HWY_DYNAMIC_DISPATCH(prolongAndUnwarpBlocks)(rotations.data(), from.empty() ? nullptr : from.data(),
                                                        coarse.data(), w.data(), r.data(), z.data(), blocks);
}

void restrictTo(const Restriction& restriction, const NodeArray& s, std::span<float> coarse, int begin, int end)
{
    HWY_DYNAMIC_DISPATCH(restrictNodes)
    (restriction.starts.data(), restriction.nodes.data(), restriction.weights.data(), s.data(), coarse.data(), begin,
     end);
}

void multiplyPanels(const std::vector<PanelRow>& panels, std::span<const float> x, std::span<float> y, int begin,
                    int end)
{
    HWY_DYNAMIC_DISPATCH(multiplyPanelRange)
    (panels.data(), x.data(), static_cast<int>(x.size()), y.data(), begin, end);
}

double gatherAndAdd(const Gather& gather, std::span<const float> corners, float scale, std::span<const float> masses,
                    std::span<const float> extra, const NodeArray& p, NodeArray& y, Blocks blocks)
{
    return HWY_DYNAMIC_DISPATCH(gatherProduct)(gather.starts.data(), gather.places.data(), corners.data(), scale,
                                               masses.data(), extra.data(), p.data(), y.data(), blocks);
}

double gatherForces(const Gather& gather, std::span<const float> corners, float scale, std::span<const float> masses,
                    std::span<const float> extra, const NodeArray& p, NodeArray& y, Blocks blocks)
{
    return HWY_DYNAMIC_DISPATCH(gatherForce)(gather.starts.data(), gather.places.data(), corners.data(), scale,
                                             masses.data(), extra.data(), p.data(), y.data(), blocks);
}

StepWork stepWork(std::span<const float> masses, const NodeArray& v, const NodeArray& dv, const NodeArray& r,
                  const NodeArray& push, Blocks blocks)
{
    return HWY_DYNAMIC_DISPATCH(stepWorkBlocks)(masses.data(), v.data(), dv.data(), r.data(), push.data(), blocks);
}

void averageRotations(const Gather& gather, std::span<const float> quaternions, std::vector<RotationBlock>& rotations,
                      Blocks blocks)
{
    HWY_DYNAMIC_DISPATCH(averageRotationBlocks)
    (gather.starts.data(), gather.places.data(), quaternions.data(), rotations.data(), blocks);
}

std::vector<std::string> simdTargets()
{
    std::vector<std::string> names;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) names.emplace_back(hwy::TargetName(target));
    return names;
}

std::string simdTarget() { return simdTargets().front(); }

void useSimdTarget(const std::string& name)
{
    hwy::SetSupportedTargetsForTest(0);
    if (!name.empty()) {
        std::int64_t found = 0;
        for (const std::int64_t target : hwy::SupportedAndGeneratedTargets())
            if (name == hwy::TargetName(target)) found = target;
        if (found == 0) fail("instruction set '", name, "': this machine has none of this name");
        hwy::SetSupportedTargetsForTest(found);
    }
    hwy::GetChosenTarget().DeInit();
}

} // namespace filasofia::linalg
#endif
