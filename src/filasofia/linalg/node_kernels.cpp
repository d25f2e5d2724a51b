#include "filasofia/linalg/node_kernels.h"

#include "filasofia/linalg/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filasofia/linalg/node_kernels.cpp"
#include <hwy/foreach_target.h>

#include "filasofia/linalg/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::linalg::HWY_NAMESPACE {

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

HWY_ATTR void updateDirectionBlocks(const float* HWY_RESTRICT z, float beta, float* HWY_RESTRICT p, Blocks blocks)
{
    const Lanes d;
    const V b = hn::Set(d, beta);
    for (std::size_t i = 64ul * blocks.begin; i < 64ul * blocks.end; i += kLanes)
        hn::Store(hn::MulAdd(b, hn::Load(d, p + i), hn::Load(d, z + i)), d, p + i);
}

HWY_ATTR double stepAlongBlocks(float alpha, const float* HWY_RESTRICT p, const float* HWY_RESTRICT q,
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

HWY_ATTR void restrictNodes(const ListRange* HWY_RESTRICT ranges, const RestrictionEntry* HWY_RESTRICT entries,
                            const float* HWY_RESTRICT s, float* HWY_RESTRICT coarse, int begin, int end)
{
    const Four d;
    alignas(16) float sum[4];
    for (int c = begin; c < end; ++c) {
        V4 even = hn::Zero(d), odd = hn::Zero(d);
        const RestrictionEntry *from = entries + ranges[c].begin, *last = entries + ranges[c].end;
        for (; from + 1 < last; from += 2) {
            even = hn::MulAdd(hn::Set(d, from[0].weight), hn::Load(d, s + 4ul * from[0].node), even);
            odd = hn::MulAdd(hn::Set(d, from[1].weight), hn::Load(d, s + 4ul * from[1].node), odd);
        }
        if (from < last) even = hn::MulAdd(hn::Set(d, from->weight), hn::Load(d, s + 4ul * from->node), even);
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
            for (int i = 0; i < rows; i += 4) { // rows is a multiple of four
                s0 = hn::MulAdd(hn::Set(d, x[i]), hn::Load(d, row[i].values + part), s0);
                s1 = hn::MulAdd(hn::Set(d, x[i + 1]), hn::Load(d, row[i + 1].values + part), s1);
                s2 = hn::MulAdd(hn::Set(d, x[i + 2]), hn::Load(d, row[i + 2].values + part), s2);
                s3 = hn::MulAdd(hn::Set(d, x[i + 3]), hn::Load(d, row[i + 3].values + part), s3);
            }
            hn::StoreU(hn::Add(hn::Add(s0, s1), hn::Add(s2, s3)), d, y + 16ul * k + part);
        }
    }
}

/// kVectorsPerPass vectors in one pass over the matrix.
HWY_ATTR void multiplyPanelBatch(const PanelRow* HWY_RESTRICT panels, const float* HWY_RESTRICT x,
                                 float* HWY_RESTRICT y, const VectorBatch& vectors, int panelCount)
{
    const Lanes d;
    for (int k = 0; k < panelCount; ++k) {
        const PanelRow* HWY_RESTRICT row = panels + static_cast<std::ptrdiff_t>(k) * vectors.rows;
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            V sums[kVectorsPerPass];
            for (V& sum : sums) sum = hn::Zero(d);
            for (int i = 0; i < vectors.rows; ++i) {
                const V a = hn::Load(d, row[i].values + part);
                for (int v = 0; v < kVectorsPerPass; ++v)
                    sums[v] =
                        hn::MulAdd(hn::Set(d, x[static_cast<std::ptrdiff_t>(v) * vectors.stride + i]), a, sums[v]);
            }
            for (int v = 0; v < kVectorsPerPass; ++v)
                hn::StoreU(sums[v], d,
                           y + static_cast<std::ptrdiff_t>(v) * vectors.resultStride + 16l * k +
                               static_cast<long>(part));
        }
    }
}

template <bool forces> HWY_INLINE double gatherBlocks(const NodeTerms& terms, const float* HWY_RESTRICT p,
                                                      float* HWY_RESTRICT y, Blocks blocks)
{
    const ListRange* HWY_RESTRICT ranges = terms.gather.ranges.data();
    const int* HWY_RESTRICT places = terms.gather.values.data();
    const float *HWY_RESTRICT corners = terms.corners.data(), *HWY_RESTRICT masses = terms.masses.data(),
                              *HWY_RESTRICT extra = terms.extra.data();
    const Four d;
    LaneSums sums;
    V4 sum[4] = {hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    const V4 s = hn::Set(d, terms.massWeight);
    for (std::size_t node = 16ul * blocks.begin; node < 16ul * blocks.end; node += 4)
        for (std::size_t k = 0; k < 4; ++k) {
            const std::size_t i = node + k;
            const V4 corner = gathered(places + ranges[i].begin, places + ranges[i].end, corners);
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

HWY_ATTR double gatherProductBlocks(const NodeTerms& terms, const float* p, float* y, Blocks blocks)
{
    return gatherBlocks<false>(terms, p, y, blocks);
}
HWY_ATTR double gatherForceBlocks(const NodeTerms& terms, const float* p, float* y, Blocks blocks)
{
    return gatherBlocks<true>(terms, p, y, blocks);
}

HWY_ATTR StepWork stepWorkBlocks(const float* HWY_RESTRICT masses, const float* HWY_RESTRICT v,
                                 const float* HWY_RESTRICT dv, const float* HWY_RESTRICT r,
                                 const float* HWY_RESTRICT carry, Blocks blocks)
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
            sums[0][k] = hn::MulAdd(hn::Sub(hn::Load(d, r + i), hn::Load(d, carry + i)), w, sums[0][k]);
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

} // namespace filasofia::linalg::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "filasofia/core/error.h"

namespace filasofia::linalg {

HWY_EXPORT(dotBlocks);
HWY_EXPORT(updateDirectionBlocks);
HWY_EXPORT(stepAlongBlocks);
HWY_EXPORT(restrictNodes);
HWY_EXPORT(multiplyPanelRange);
HWY_EXPORT(multiplyPanelBatch);
HWY_EXPORT(gatherProductBlocks);
HWY_EXPORT(gatherForceBlocks);
HWY_EXPORT(stepWorkBlocks);

double dot(const NodeArray& a, const NodeArray& b, Blocks blocks)
{
    return HWY_DYNAMIC_DISPATCH(dotBlocks)(a.data(), b.data(), blocks);
}

void updateDirection(const NodeArray& z, float beta, NodeArray& p, Blocks blocks)
{
    HWY_DYNAMIC_DISPATCH(updateDirectionBlocks)(z.data(), beta, p.data(), blocks);
}

double stepAlong(float alpha, const NodeArray& p, const NodeArray& q, NodeArray& x, NodeArray& r, Blocks blocks)
{
    return HWY_DYNAMIC_DISPATCH(stepAlongBlocks)(alpha, p.data(), q.data(), x.data(), r.data(), blocks);
}

void restrictTo(const Restriction& restriction, const NodeArray& s, std::span<float> coarse, int begin, int end)
{
    HWY_DYNAMIC_DISPATCH(restrictNodes)
    (restriction.ranges.data(), restriction.values.data(), s.data(), coarse.data(), begin, end);
}

void multiplyPanels(std::span<const PanelRow> panels, std::span<const float> x, std::span<float> y, int begin, int end)
{
    HWY_DYNAMIC_DISPATCH(multiplyPanelRange)
    (panels.data(), x.data(), static_cast<int>(x.size()), y.data(), begin, end);
}

void multiplyPanels(std::span<const PanelRow> panels, std::span<const float> x, std::span<float> y,
                    const VectorBatch& vectors, int panelCount)
{
    const auto from = [&](int vector) {
        return static_cast<std::size_t>(vector) * static_cast<std::size_t>(vectors.stride);
    };
    const auto to = [&](int vector) {
        return static_cast<std::size_t>(vector) * static_cast<std::size_t>(vectors.resultStride);
    };
    int first = 0;
    for (; first + kVectorsPerPass <= vectors.count; first += kVectorsPerPass) HWY_DYNAMIC_DISPATCH(multiplyPanelBatch)
    (panels.data(), x.data() + from(first), y.data() + to(first), vectors, panelCount);
    for (; first < vectors.count; ++first)
        multiplyPanels(panels, x.subspan(from(first), static_cast<std::size_t>(vectors.rows)), y.subspan(to(first)), 0,
                       panelCount);
}

double gatherAndAdd(const NodeTerms& terms, const NodeArray& p, NodeArray& y, Blocks blocks)
{
    return HWY_DYNAMIC_DISPATCH(gatherProductBlocks)(terms, p.data(), y.data(), blocks);
}

double gatherForces(const NodeTerms& terms, const NodeArray& p, NodeArray& y, Blocks blocks)
{
    return HWY_DYNAMIC_DISPATCH(gatherForceBlocks)(terms, p.data(), y.data(), blocks);
}

StepWork stepWork(std::span<const float> masses, const NodeArray& v, const NodeArray& dv, const NodeArray& r,
                  const NodeArray& carry, Blocks blocks)
{
    return HWY_DYNAMIC_DISPATCH(stepWorkBlocks)(masses.data(), v.data(), dv.data(), r.data(), carry.data(), blocks);
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
