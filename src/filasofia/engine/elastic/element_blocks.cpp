#include "filasofia/engine/elastic/element_blocks.h"

#include "filasofia/linalg/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filasofia/engine/elastic/element_blocks.cpp"
#include <hwy/foreach_target.h>

#include "filasofia/engine/elastic/corotational_lanes-inl.h"
#include "filasofia/engine/elastic/neo_hookean_lanes-inl.h"
#include "filasofia/engine/elastic/stretch_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {
using linalg::HWY_NAMESPACE::storeGroup;

/// Writes the contributions to the four nodes of an element. Three are given; the four sum to zero.
HWY_INLINE void storeCorners(const V3 (&c)[3], float* HWY_RESTRICT corners, std::size_t part)
{
    const V zero = hn::Zero(Lanes());
    storeGroup(negative(c[0] + c[1] + c[2]), zero, corners, part);
    for (int k = 0; k < 3; ++k) storeGroup(c[k], zero, corners + 64 * (k + 1), part);
}

/// `Law` is a law with a form of its own, or any law by its response to the principal stretches.
template <class Law> HWY_ATTR void updateBlocks(const Law& law, std::span<const ElementBlock> all,
                                                const BlockInput& input, linalg::Blocks blocks,
                                                const ElementOutput& output)
{
    using Tangent = decltype(linearise(law, std::declval<const LaneElement&>(), std::declval<V3(&)[3]>()));
    using Block = typename Tangent::Block;
    const ElementBlock* HWY_RESTRICT elements = all.data();
    const float *HWY_RESTRICT x = input.x.data(), *HWY_RESTRICT v = input.v.data();
    ElementRotations* HWY_RESTRICT rotations = output.rotations.data();
    Block* HWY_RESTRICT tangents = std::get<std::vector<Block>>(output.tangents).data();
    float *HWY_RESTRICT corners = output.corners.data(), *HWY_RESTRICT quaternions = output.quaternions.data();
    const Lanes d;
    LaneElement at;
    at.force = lane(input.weights.force);
    at.stiffness = lane(input.weights.stiffness);
    at.turning = lane(input.weights.turning);
    for (int block = blocks.begin; block < blocks.end; ++block) {
        const ElementBlock& element = elements[block];
        Block& out = tangents[block];
        std::copy_n(element.nodes[0], 4 * kBlock, out.nodes[0]);
        std::uint32_t inverted = 0;
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            loadEdges(x, element.nodes, part, at.edges);
            loadGradients(element.gradients, part, at.g);
            at.f = gradientOf(at.edges, at.g);
            at.r = matrixOf(updateRotation(at.f, part, rotations[block], quaternions + 64l * block));
            at.mu = hn::Load(d, element.mu + part);
            at.ratio = hn::Load(d, element.ratio + part);
            V3 forces[3], rates[3], damping[3], total[3];
            const Tangent tangent = linearise(law, at, forces);
            tangent.store(out, part);
            loadEdges(v, element.nodes, part, rates);
            tangent.times(rates, damping);
            for (int k = 0; k < 3; ++k) total[k] = negative(forces[k] + damping[k]);
            storeCorners(total, corners + static_cast<long>(kElementCorners) * block, part);
            inverted |= bitsOf(hn::Not(hn::Gt(determinant(at.f), hn::Zero(d)))) << part;
        }
        output.inverted[static_cast<std::size_t>(block)] = static_cast<std::uint16_t>(inverted);
    }
}

template <class Tangent> HWY_ATTR void multiplyBlocks(const typename Tangent::Block* HWY_RESTRICT tangents,
                                                      const float* HWY_RESTRICT p, float* HWY_RESTRICT corners,
                                                      linalg::Blocks blocks)
{
    for (int block = blocks.begin; block < blocks.end; ++block)
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            V3 edges[3], out[3];
            loadEdges(p, tangents[block].nodes, part, edges);
            Tangent::load(tangents[block], part).times(edges, out);
            storeCorners(out, corners + static_cast<long>(kElementCorners) * block, part);
        }
}

HWY_ATTR void updateElementBlocks(const physics::ElasticLaw& law, std::span<const ElementBlock> elements,
                                  const BlockInput& input, linalg::Blocks blocks, const ElementOutput& output)
{
    if (const auto* corotational = std::get_if<physics::Corotational>(&law))
        updateBlocks(*corotational, elements, input, blocks, output);
    else if (const auto* neoHookean = std::get_if<physics::NeoHookean>(&law))
        updateBlocks(*neoHookean, elements, input, blocks, output);
    else
        updateBlocks(law, elements, input, blocks, output);
}

HWY_ATTR void multiplyElementBlocks(const ElementTangents& tangents, const float* p, float* corners,
                                    linalg::Blocks blocks)
{
    if (const auto* warped = std::get_if<std::vector<WarpedBlock>>(&tangents))
        multiplyBlocks<WarpedLanes>(warped->data(), p, corners, blocks);
    else if (const auto* neoHookean = std::get_if<std::vector<NeoHookeanBlock>>(&tangents))
        multiplyBlocks<NeoHookeanLanes>(neoHookean->data(), p, corners, blocks);
    else
        multiplyBlocks<StretchLanes>(std::get<std::vector<StretchBlock>>(tangents).data(), p, corners, blocks);
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace filasofia::engine {

HWY_EXPORT(updateElementBlocks);
HWY_EXPORT(multiplyElementBlocks);

ElementTangents makeTangents(const physics::ElasticLaw& law, std::size_t blocks)
{
    if (std::holds_alternative<physics::Corotational>(law)) return std::vector<WarpedBlock>(blocks);
    if (std::holds_alternative<physics::NeoHookean>(law)) return std::vector<NeoHookeanBlock>(blocks);
    return std::vector<StretchBlock>(blocks);
}

void updateElements(const physics::ElasticLaw& law, std::span<const ElementBlock> elements, const BlockInput& input,
                    linalg::Blocks blocks, const ElementOutput& output)
{
    HWY_DYNAMIC_DISPATCH(updateElementBlocks)(law, elements, input, blocks, output);
}

void multiplyElements(const ElementTangents& tangents, const linalg::NodeArray& p, std::span<float> corners,
                      linalg::Blocks blocks)
{
    HWY_DYNAMIC_DISPATCH(multiplyElementBlocks)(tangents, p.data(), corners.data(), blocks);
}

} // namespace filasofia::engine
#endif
