#include "filasofia/engine/elastic/element_blocks.h"

#include "filasofia/linalg/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filasofia/engine/elastic/element_blocks.cpp"
#include <hwy/foreach_target.h>

#include "filasofia/engine/elastic/corotational_lanes-inl.h"
#include "filasofia/engine/elastic/fibre_lanes-inl.h"
#include "filasofia/engine/elastic/neo_hookean_lanes-inl.h"
#include "filasofia/engine/elastic/relaxation_lanes-inl.h"
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

/// By how much a principal stretch differs from 1 at most. The stretches are computed only if a bound of them does by
/// more than `limit`, otherwise the bound is returned: the eigenvalues of a symmetric matrix lie within
/// mean +- sqrt(2/3) |deviator|.
HWY_INLINE V strainOf(V limit, const LaneElement& at)
{
    const M3 sym = transposeTimes(at.r, at.f);
    const V mean = hn::Mul(lane(1.0f / 3.0f), hn::Add(hn::Add(sym.m[0][0], sym.m[1][1]), sym.m[2][2]));
    V square = hn::Zero(Lanes());
    for (int k = 0; k < 9; ++k) {
        const V entry = k % 4 == 0 ? hn::Sub(sym.m[k / 3][k % 3], mean) : sym.m[k / 3][k % 3];
        square = hn::MulAdd(entry, entry, square);
    }
    const V bound = hn::MulAdd(lane(0.81649658f), hn::Sqrt(square), hn::Abs(hn::Sub(mean, lane(1.0f))));
    if (hn::AllTrue(Lanes(), hn::Le(bound, limit))) return bound;
    Lane a[3][3], axes[3][3];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) a[i][j] = Lane(sym.m[i][j]);
    diagonalise(a, axes);
    Lane strain = 0.0;
    for (int i = 0; i < 3; ++i) strain = larger(strain, magnitude(a[i][i] - Lane(1.0)));
    return strain.v;
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
    float* HWY_RESTRICT strains = output.strains.data();
    const Lanes d;
    const bool limited = input.validStrain < std::numeric_limits<float>::infinity();
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
            if (input.relaxation)
                relax(*input.relaxation, at, part, output.relaxation[static_cast<std::size_t>(block)], forces);
            for (std::size_t family = 0; family < output.fibres.families.size(); ++family) {
                const std::size_t place = family * all.size() + static_cast<std::size_t>(block);
                const FibreLanes fibres = lineariseFibres(output.fibres.families[family], output.fibres.blocks[place],
                                                          part, at, input.weights, forces);
                fibres.store(output.fibres.tangents[place], part);
                fibres.addTimes(rates, damping);
            }
            for (int k = 0; k < 3; ++k) total[k] = negative(forces[k] + damping[k]);
            storeCorners(total, corners + static_cast<long>(kElementCorners) * block, part);
            inverted |= bitsOf(hn::Not(hn::Gt(determinant(at.f), hn::Zero(d)))) << part;
            if (limited) hn::StoreU(strainOf(lane(input.validStrain), at), d, strains + block * kBlock + part);
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

/// The same with fibres: a loop of its own, because the test for them in the other one took 2 % of a step.
template <class Tangent> HWY_ATTR void multiplyWithFibres(const std::vector<typename Tangent::Block>& tangents,
                                                          std::span<const FibreTangentBlock> fibres,
                                                          const float* HWY_RESTRICT p, float* HWY_RESTRICT corners,
                                                          linalg::Blocks blocks)
{
    for (int block = blocks.begin; block < blocks.end; ++block) {
        const auto b = static_cast<std::size_t>(block);
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            V3 edges[3], out[3];
            loadEdges(p, tangents[b].nodes, part, edges);
            Tangent::load(tangents[b], part).times(edges, out);
            for (std::size_t place = b; place < fibres.size(); place += tangents.size())
                FibreLanes::load(fibres[place], part).addTimes(edges, out);
            storeCorners(out, corners + kElementCorners * b, part);
        }
    }
}

template <class Tangent> HWY_ATTR void multiply(const std::vector<typename Tangent::Block>& tangents,
                                                std::span<const FibreTangentBlock> fibres, const float* p,
                                                float* corners, linalg::Blocks blocks)
{
    if (fibres.empty())
        multiplyBlocks<Tangent>(tangents.data(), p, corners, blocks);
    else
        multiplyWithFibres<Tangent>(tangents, fibres, p, corners, blocks);
}

template <class Tangent> HWY_ATTR void diagonalBlocks(const std::vector<typename Tangent::Block>& tangents,
                                                      std::span<const FibreTangentBlock> fibres, float* own,
                                                      float* mixed, linalg::Blocks blocks)
{
    const V zero = hn::Zero(Lanes());
    for (int block = blocks.begin; block < blocks.end; ++block) {
        const auto b = static_cast<std::size_t>(block);
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            DiagonalLanes diagonal;
            Tangent::load(tangents[b], part).addDiagonal(diagonal);
            for (std::size_t place = b; place < fibres.size(); place += tangents.size())
                FibreLanes::load(fibres[place], part).addDiagonal(diagonal);
            for (std::size_t k = 0; k < 4; ++k) {
                storeGroup(diagonal.own[k], zero, own + kElementCorners * b + 64 * k, part);
                storeGroup(diagonal.mixed[k], zero, mixed + kElementCorners * b + 64 * k, part);
            }
        }
    }
}

HWY_ATTR void diagonalElementBlocks(const ElementTangents& tangents, std::span<const FibreTangentBlock> fibres,
                                    float* own, float* mixed, linalg::Blocks blocks)
{
    if (const auto* neoHookean = std::get_if<std::vector<NeoHookeanBlock>>(&tangents))
        diagonalBlocks<NeoHookeanLanes>(*neoHookean, fibres, own, mixed, blocks);
    else
        diagonalBlocks<StretchLanes>(std::get<std::vector<StretchBlock>>(tangents), fibres, own, mixed, blocks);
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

HWY_ATTR void multiplyElementBlocks(const ElementTangents& tangents, std::span<const FibreTangentBlock> fibres,
                                    const float* p, float* corners, linalg::Blocks blocks)
{
    if (const auto* warped = std::get_if<std::vector<WarpedBlock>>(&tangents))
        multiply<WarpedLanes>(*warped, fibres, p, corners, blocks);
    else if (const auto* neoHookean = std::get_if<std::vector<NeoHookeanBlock>>(&tangents))
        multiply<NeoHookeanLanes>(*neoHookean, fibres, p, corners, blocks);
    else
        multiply<StretchLanes>(std::get<std::vector<StretchBlock>>(tangents), fibres, p, corners, blocks);
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace filasofia::engine {

HWY_EXPORT(updateElementBlocks);
HWY_EXPORT(multiplyElementBlocks);
HWY_EXPORT(diagonalElementBlocks);

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

void multiplyElements(const ElementTangents& tangents, std::span<const FibreTangentBlock> fibres,
                      const linalg::NodeArray& p, std::span<float> corners, linalg::Blocks blocks)
{
    HWY_DYNAMIC_DISPATCH(multiplyElementBlocks)(tangents, fibres, p.data(), corners.data(), blocks);
}

void diagonalOfElements(const ElementTangents& tangents, std::span<const FibreTangentBlock> fibres,
                        std::span<float> own, std::span<float> mixed, linalg::Blocks blocks)
{
    HWY_DYNAMIC_DISPATCH(diagonalElementBlocks)(tangents, fibres, own.data(), mixed.data(), blocks);
}

} // namespace filasofia::engine
#endif
