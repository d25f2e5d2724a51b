#include "filasofia/engine/elastic/shell_blocks.h"

#include "filasofia/linalg/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filasofia/engine/elastic/bending_blocks.cpp"
#include <hwy/foreach_target.h>

#include "filasofia/engine/elastic/triangle_lanes-inl.h"

#include <hwy/contrib/math/math-inl.h>

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {
namespace {

/// One edge between a triangle and its neighbour; the symbols are those of BendingTangentBlock.
struct Edge {
    V3 own, across;
    V ownFoot, acrossFoot;
};

struct Bend {
    V theta;
    Edge edge;
};

/// Edge b c with the corner a of the triangle itself and d of its neighbour, as hingeAt() in bending.cpp.
HWY_INLINE Bend bendAt(V3 a, V3 b, V3 c, V3 d, V leastArea)
{
    const Lanes lanes;
    const V one = hn::Set(lanes, 1.0f), tiny = hn::Set(lanes, 1e-30f);
    const V3 along = c - b, own = cross(along, a - c), other = cross(d - c, along);
    const V size = hn::Max(dot(along, along), tiny), length = hn::Sqrt(size), perSize = hn::Div(one, size);
    const V3 m = unit(own), n = unit(other);
    // tan(theta / 2) = sin / (1 + cos). Folded flat, both are rounding: theta is then near pi, or 0 if both are zero.
    const V sine = hn::Div(dot(cross(m, n), along), length);
    const V half = hn::Max(hn::Add(one, dot(m, n)), hn::Set(lanes, 1e-7f));
    const V ownRate = hn::Div(length, hn::Max(dot(own, own), leastArea));
    const V acrossRate = hn::Div(length, hn::Max(dot(other, other), leastArea));
    return {.theta = hn::Mul(hn::Set(lanes, 2.0f), hn::CallAtan(lanes, hn::Div(sine, half))),
            .edge = {.own = ownRate * own,
                     .across = acrossRate * other,
                     .ownFoot = hn::Mul(dot(a - b, along), perSize),
                     .acrossFoot = hn::Mul(dot(d - b, along), perSize)}};
}

HWY_INLINE V3 between(V3 a, V3 b, V share)
{
    return {hn::MulAdd(share, hn::Sub(b.x, a.x), a.x), hn::MulAdd(share, hn::Sub(b.y, a.y), a.y),
            hn::MulAdd(share, hn::Sub(b.z, a.z), a.z)};
}

/// grad theta . p for the vectors p at a, b, c, d.
HWY_INLINE V rate(const Edge& e, V3 a, V3 b, V3 c, V3 d)
{
    return hn::Add(dot(e.own, between(b, c, e.ownFoot) - a), dot(e.across, between(b, c, e.acrossFoot) - d));
}

/// Adds moment * grad theta to the vectors at a, b, c, d.
HWY_INLINE void addGradient(V moment, const Edge& e, V3& a, V3& b, V3& c, V3& d)
{
    const V3 g = moment * e.own, h = moment * e.across;
    const V3 second = e.ownFoot * g + e.acrossFoot * h;
    a = a - g;
    d = d - h;
    c = c + second;
    b = b + (g + h - second);
}

/// A symmetric 3 x 3 matrix 00 01 02 11 12 22 times three numbers.
HWY_INLINE void product(const float (&s)[6][kBlock], std::size_t part, const V (&a)[3], V (&out)[3])
{
    const Lanes d;
    V m[6];
    for (int k = 0; k < 6; ++k) m[k] = hn::Load(d, s[k] + part);
    out[0] = sumOfProducts(m[0], a[0], m[1], a[1], m[2], a[2]);
    out[1] = sumOfProducts(m[1], a[0], m[3], a[1], m[4], a[2]);
    out[2] = sumOfProducts(m[2], a[0], m[4], a[1], m[5], a[2]);
}

HWY_INLINE void storeVector(V3 v, float (&to)[3][kBlock], std::size_t part)
{
    const Lanes d;
    hn::Store(v.x, d, to[0] + part);
    hn::Store(v.y, d, to[1] + part);
    hn::Store(v.z, d, to[2] + part);
}
HWY_INLINE V3 loadVector(const float (&from)[3][kBlock], std::size_t part)
{
    const Lanes d;
    return {hn::Load(d, from[0] + part), hn::Load(d, from[1] + part), hn::Load(d, from[2] + part)};
}

HWY_INLINE void gatherSix(const float* HWY_RESTRICT from, const int (&nodes)[6][kBlock], std::size_t part, V3 (&out)[6])
{
    for (int i = 0; i < 6; ++i) out[i] = gatherNodes(from, nodes[i] + part);
}

/// Stores sum of moment_i grad theta_i at the six corners.
HWY_INLINE void storeBends(const V (&moments)[3], const Edge (&edges)[3], float* HWY_RESTRICT out, std::size_t part)
{
    const V zero = hn::Zero(Lanes());
    V3 corners[6];
    for (V3& each : corners) each = {zero, zero, zero};
    for (int i = 0; i < 3; ++i)
        addGradient(moments[i], edges[i], corners[i], corners[(i + 1) % 3], corners[(i + 2) % 3], corners[3 + i]);
    for (int i = 0; i < 6; ++i) storeGroup(corners[i], zero, out + 64 * i, part);
}

} // namespace

HWY_ATTR void updateBendBlocks(std::span<const BendingBlock> all, const BlockInput& input, linalg::Blocks blocks,
                               const BendingOutput& output)
{
    const float *HWY_RESTRICT x = input.x.data(), *HWY_RESTRICT v = input.v.data();
    const Lanes d;
    const V force = hn::Set(d, input.weights.force), weight = hn::Set(d, input.weights.stiffness);
    for (int b = blocks.begin; b < blocks.end; ++b)
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            const BendingBlock& block = all[static_cast<std::size_t>(b)];
            BendingTangentBlock& tangent = output.tangents[static_cast<std::size_t>(b)];
            V3 at[6], rates[6];
            gatherSix(x, block.nodes, part, at);
            gatherSix(v, block.nodes, part, rates);
            const V leastArea = hn::Load(d, block.leastArea + part);
            Edge edges[3];
            V bent[3]; // what the stiffness is multiplied by: force * (theta - theta_rest) + weight * its rate
            for (int i = 0; i < 3; ++i) {
                const int j = (i + 1) % 3, k = (i + 2) % 3;
                const Bend bend = bendAt(at[i], at[j], at[k], at[3 + i], leastArea);
                edges[i] = bend.edge;
                storeVector(edges[i].own, tangent.own[i], part);
                storeVector(edges[i].across, tangent.across[i], part);
                hn::Store(edges[i].ownFoot, d, tangent.feet[i][0] + part);
                hn::Store(edges[i].acrossFoot, d, tangent.feet[i][1] + part);
                const V change = hn::Sub(bend.theta, hn::Load(d, block.restAngles[i] + part));
                const V speed = rate(edges[i], rates[i], rates[j], rates[k], rates[3 + i]);
                bent[i] = hn::MulAdd(force, change, hn::Mul(weight, speed));
            }
            for (int k = 0; k < 6; ++k)
                hn::Store(hn::Mul(weight, hn::Load(d, block.stiffness[k] + part)), d, tangent.stiffness[k] + part);
            V moments[3];
            product(block.stiffness, part, bent, moments);
            for (V& each : moments) each = hn::Neg(each);
            storeBends(moments, edges, output.corners.data() + static_cast<long>(kBendingCorners) * b, part);
        }
}

HWY_ATTR void multiplyBendBlocks(std::span<const BendingTangentBlock> all, const float* HWY_RESTRICT p,
                                 float* HWY_RESTRICT corners, linalg::Blocks blocks)
{
    const Lanes d;
    for (int b = blocks.begin; b < blocks.end; ++b)
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            const BendingTangentBlock& block = all[static_cast<std::size_t>(b)];
            V3 at[6];
            gatherSix(p, block.nodes, part, at);
            Edge edges[3];
            V rates[3], moments[3];
            for (int i = 0; i < 3; ++i) {
                edges[i] = {.own = loadVector(block.own[i], part),
                            .across = loadVector(block.across[i], part),
                            .ownFoot = hn::Load(d, block.feet[i][0] + part),
                            .acrossFoot = hn::Load(d, block.feet[i][1] + part)};
                rates[i] = rate(edges[i], at[i], at[(i + 1) % 3], at[(i + 2) % 3], at[3 + i]);
            }
            product(block.stiffness, part, rates, moments);
            storeBends(moments, edges, corners + static_cast<long>(kBendingCorners) * b, part);
        }
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace filasofia::engine {

HWY_EXPORT(updateBendBlocks);
HWY_EXPORT(multiplyBendBlocks);

void updateBends(std::span<const BendingBlock> bends, const BlockInput& input, linalg::Blocks blocks,
                 const BendingOutput& output)
{
    HWY_DYNAMIC_DISPATCH(updateBendBlocks)(bends, input, blocks, output);
}

void multiplyBends(std::span<const BendingTangentBlock> tangents, const linalg::NodeArray& p, std::span<float> corners,
                   linalg::Blocks blocks)
{
    HWY_DYNAMIC_DISPATCH(multiplyBendBlocks)(tangents, p.data(), corners.data(), blocks);
}

} // namespace filasofia::engine
#endif
