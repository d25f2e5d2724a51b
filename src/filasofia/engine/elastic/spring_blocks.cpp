#include "filasofia/engine/elastic/spring_blocks.h"

#include "filasofia/linalg/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filasofia/engine/elastic/spring_blocks.cpp"
#include <hwy/foreach_target.h>

#include "filasofia/engine/elastic/element_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {
using linalg::HWY_NAMESPACE::storeGroup;

/// A symmetric matrix, given by its six entries, times a vector.
HWY_INLINE V3 symmetricTimes(const V (&m)[6], V3 a)
{
    return {dot({m[0], m[1], m[2]}, a), dot({m[1], m[3], m[4]}, a), dot({m[2], m[4], m[5]}, a)};
}

HWY_ATTR void updateSpringBlocks(std::span<const SpringBlock> all, const BlockInput& input, linalg::Blocks blocks,
                                 const SpringOutput& output)
{
    const SpringBlock* HWY_RESTRICT springs = all.data();
    const float *HWY_RESTRICT x = input.x.data(), *HWY_RESTRICT v = input.v.data();
    SpringMatrixBlock* HWY_RESTRICT matrices = output.matrices.data();
    float* HWY_RESTRICT corners = output.corners.data();
    const Lanes d;
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0f), force = hn::Set(d, input.weights.force);
    const V stiffness = hn::Set(d, input.weights.stiffness), damping = hn::Set(d, input.weights.damping);
    for (int block = blocks.begin; block < blocks.end; ++block)
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            const SpringBlock& spring = springs[block];
            const V3 edge = gatherNodes(x, spring.nodes[1] + part) - gatherNodes(x, spring.nodes[0] + part);
            const V3 rate = gatherNodes(v, spring.nodes[1] + part) - gatherNodes(v, spring.nodes[0] + part);
            const V length = hn::Sqrt(dot(edge, edge)), rest = hn::Load(d, spring.restLength + part);
            // Coincident ends have no direction: their force is zero, never a NaN.
            const auto apart = hn::Gt(length, hn::Set(d, 1e-12f));
            const V inverse = hn::IfThenElseZero(apart, hn::Div(one, hn::IfThenElse(apart, length, one)));
            const V3 along = inverse * edge;
            const V k = hn::Load(d, spring.stiffness + part), c = hn::Load(d, spring.damping + part);

            // K = k ( (1 - t) d d^T + t I ) with t = 1 - rest / length if the spring is stretched, 0 if it is
            // compressed, as in springStiffness; the dashpot adds c d d^T.
            const V taut = hn::Max(zero, hn::NegMulAdd(rest, inverse, one));
            const V across = hn::Mul(hn::Mul(stiffness, k), hn::IfThenElseZero(apart, taut));
            const V straight =
                hn::MulAdd(hn::Mul(stiffness, k), hn::Sub(one, hn::IfThenElseZero(apart, taut)), hn::Mul(damping, c));
            const V3 s = straight * along;
            const V m[6] = {hn::MulAdd(s.x, along.x, across), hn::Mul(s.x, along.y), hn::Mul(s.x, along.z),
                            hn::MulAdd(s.y, along.y, across), hn::Mul(s.y, along.z), hn::MulAdd(s.z, along.z, across)};
            for (int i = 0; i < 6; ++i) hn::Store(m[i], d, matrices[block].m[i] + part);

            const V size = hn::Mul(hn::Mul(force, k), hn::Sub(length, rest));
            const V3 total = size * along + symmetricTimes(m, rate);
            float* out = corners + static_cast<long>(kSpringCorners) * block;
            storeGroup(total, zero, out, part);
            storeGroup(negative(total), zero, out + 64, part);
        }
}

HWY_ATTR void multiplySpringBlocks(const SpringMatrixBlock* HWY_RESTRICT matrices, const float* HWY_RESTRICT p,
                                   float* HWY_RESTRICT corners, linalg::Blocks blocks)
{
    const Lanes d;
    for (int block = blocks.begin; block < blocks.end; ++block)
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            const SpringMatrixBlock& spring = matrices[block];
            V m[6];
            for (int i = 0; i < 6; ++i) m[i] = hn::Load(d, spring.m[i] + part);
            const V3 product =
                symmetricTimes(m, gatherNodes(p, spring.nodes[0] + part) - gatherNodes(p, spring.nodes[1] + part));
            float* out = corners + static_cast<long>(kSpringCorners) * block;
            storeGroup(product, hn::Zero(d), out, part);
            storeGroup(negative(product), hn::Zero(d), out + 64, part);
        }
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace filasofia::engine {

HWY_EXPORT(updateSpringBlocks);
HWY_EXPORT(multiplySpringBlocks);

void updateSprings(std::span<const SpringBlock> springs, const BlockInput& input, linalg::Blocks blocks,
                   const SpringOutput& output)
{
    HWY_DYNAMIC_DISPATCH(updateSpringBlocks)(springs, input, blocks, output);
}

void multiplySprings(std::span<const SpringMatrixBlock> matrices, const linalg::NodeArray& p, std::span<float> corners,
                     linalg::Blocks blocks)
{
    HWY_DYNAMIC_DISPATCH(multiplySpringBlocks)(matrices.data(), p.data(), corners.data(), blocks);
}

} // namespace filasofia::engine
#endif
