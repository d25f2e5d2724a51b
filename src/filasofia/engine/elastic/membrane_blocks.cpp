#include "filasofia/engine/elastic/membrane.h"
#include "filasofia/engine/elastic/shell_blocks.h"

#include "filasofia/linalg/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filasofia/engine/elastic/membrane_blocks.cpp"
#include <hwy/foreach_target.h>

#include "filasofia/engine/elastic/triangle_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {
namespace {

/// A triangle and its law at a state; the symbols are those of membrane.cpp.
struct Sheet {
    V3 e1, e2, normal;
    V g11, g12, g22, root; ///< the metric, and the root of its determinant
    V t, a, apart, phi1, phi2, psi1, psi2, q;
};

HWY_INLINE Sheet sheetAt(const MembraneBlock& block, const float* HWY_RESTRICT x, std::size_t part)
{
    const Lanes d;
    const V one = hn::Set(d, 1.0f), least = hn::Set(d, static_cast<float>(kLeastTrace));
    Sheet s;
    const V3 origin = gatherNodes(x, block.nodes[0] + part);
    s.e1 = gatherNodes(x, block.nodes[1] + part) - origin;
    s.e2 = gatherNodes(x, block.nodes[2] + part) - origin;
    s.g11 = hn::Load(d, block.metric[0] + part);
    s.g12 = hn::Load(d, block.metric[1] + part);
    s.g22 = hn::Load(d, block.metric[2] + part);
    s.q = hn::Load(d, block.q + part);
    const V det = hn::Load(d, block.det + part);
    s.root = hn::Sqrt(det);
    const V3 doubled = cross(s.e1, s.e2);
    s.normal = unit(doubled);
    s.t = sumOfProducts(s.g11, dot(s.e1, s.e1), twice(s.g12), dot(s.e1, s.e2), s.g22, dot(s.e2, s.e2));
    s.a = hn::Mul(det, dot(doubled, doubled));
    const V b22 = hn::Sqrt(s.g22), inverse = hn::Div(one, b22);
    const V3 f1 = hn::Mul(s.root, inverse) * s.e1, f2 = hn::Mul(s.g12, inverse) * s.e1 + b22 * s.e2;
    const V unequal = hn::Mul(hn::Set(d, 0.5f), hn::Sub(dot(f1, f1), dot(f2, f2))), sheared = dot(f1, f2);
    s.apart = hn::Sqrt(hn::MulAdd(unequal, unequal, hn::Mul(sheared, sheared)));

    // phi' and phi''; psi' = -(1 + q)^2 / (q + a)^2, psi'' = -2 psi' / (q + a)
    const auto crushed = hn::Lt(s.t, least);
    s.phi1 = hn::IfThenElse(crushed, hn::Div(s.t, least), one);
    s.phi2 = hn::IfThenElseZero(crushed, hn::Div(one, least));
    const V over = hn::Div(one, hn::Add(s.q, s.a)), ratio = hn::Mul(hn::Add(one, s.q), over);
    s.psi1 = hn::Neg(hn::Mul(ratio, ratio));
    s.psi2 = hn::Mul(hn::Mul(hn::Set(d, -2.0f), s.psi1), over);
    return s;
}

/// Three numbers of a symmetric 2 x 2 matrix of the edges.
struct Two {
    V aa, ab, bb;
};

/// T = phi' G + psi' det G cof E
HWY_INLINE Two edgeStress(const Sheet& s)
{
    const V c = hn::Mul(s.psi1, hn::Mul(s.root, s.root));
    return {hn::MulAdd(c, dot(s.e2, s.e2), hn::Mul(s.phi1, s.g11)),
            hn::NegMulAdd(c, dot(s.e1, s.e2), hn::Mul(s.phi1, s.g12)),
            hn::MulAdd(c, dot(s.e1, s.e1), hn::Mul(s.phi1, s.g22))};
}

/// T without its pressure, times `turning`.
HWY_INLINE Two tension(const Sheet& s, const Two& stress, V turning)
{
    const Lanes d;
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Mul(hn::Set(d, 0.5f), s.t);
    const V high = hn::MulAdd(s.psi1, hn::Sub(half, s.apart), s.phi1);
    const V low = hn::MulAdd(s.psi1, hn::Add(half, s.apart), s.phi1);
    // If one is tension and the other pressure, they differ: only then is the quotient used.
    const auto all = hn::Ge(low, zero), some = hn::AndNot(all, hn::Gt(high, zero));
    const V mixed = hn::Div(hn::IfThenElseZero(some, high), hn::IfThenElse(some, hn::Sub(high, low), one));
    const V share = hn::IfThenElse(all, one, mixed), shift = hn::Neg(hn::Mul(share, hn::Min(low, zero)));
    const V scaled = hn::Mul(turning, share), moved = hn::Mul(turning, shift);
    return {hn::MulAdd(scaled, stress.aa, hn::Mul(moved, s.g11)), hn::MulAdd(scaled, stress.ab, hn::Mul(moved, s.g12)),
            hn::MulAdd(scaled, stress.bb, hn::Mul(moved, s.g22))};
}

/// straight g (1 - n n^T) + t n n^T + growth a b^T + bent r s^T, the entry of components i and j.
struct TangentTerms {
    V straight, growth, bent;
    V normal[3];
    V area[2][3], trace[2][3]; ///< dA and dt / 2 by edge
};
/// Two edges, the product g of the metric at rest and the tension t between them.
struct EdgePair {
    HWY_INLINE EdgePair(int first, int second, V product, V tension) : a(first), b(second), g(product), t(tension) {}
    int a, b;
    V g, t;
};
HWY_INLINE V entry(const TangentTerms& k, const EdgePair& edges, int i, int j)
{
    const V flat = hn::Mul(k.straight, edges.g), across = hn::Sub(edges.t, flat);
    V sum = hn::Mul(hn::Mul(across, k.normal[i]), k.normal[j]);
    if (i == j) sum = hn::Add(sum, flat);
    sum = hn::MulAdd(hn::Mul(k.growth, k.area[edges.a][i]), k.area[edges.b][j], sum);
    return hn::MulAdd(hn::Mul(k.bent, k.trace[edges.a][i]), k.trace[edges.b][j], sum);
}

HWY_INLINE void split(V3 from, V (&to)[3])
{
    to[0] = from.x;
    to[1] = from.y;
    to[2] = from.z;
}

/// The tangent of membraneTangent(), times `weight`.
HWY_INLINE void writeTangent(const Sheet& s, const Two& stress, V turning, V weight, MembraneTangentBlock& out,
                             std::size_t part)
{
    const Lanes d;
    const V zero = hn::Zero(d), half = hn::Set(d, 0.5f), two = hn::Set(d, 2.0f);
    const V c = hn::Neg(hn::Mul(hn::Sqrt(s.a), s.psi1));
    const V twist = hn::Mul(turning, hn::Max(zero, hn::Sub(s.phi1, c))), whole = hn::Add(s.phi1, c);
    const V turned = hn::Mul(weight, hn::Mul(hn::Mul(half, hn::Sub(whole, twist)), s.root));
    TangentTerms k;
    k.straight = hn::Mul(weight, hn::Mul(half, hn::Add(whole, twist)));
    k.growth = hn::Mul(weight, hn::Max(zero, hn::MulAdd(hn::Mul(two, s.a), s.psi2, s.psi1)));
    k.bent = hn::Mul(weight, hn::Mul(two, s.phi2));
    split(s.normal, k.normal);
    split(s.root * cross(s.e2, s.normal), k.area[0]);
    split(s.root * cross(s.normal, s.e1), k.area[1]);
    split(s.g11 * s.e1 + s.g12 * s.e2, k.trace[0]);
    split(s.g12 * s.e1 + s.g22 * s.e2, k.trace[1]);
    Two t = tension(s, stress, turning);
    t = {hn::Mul(weight, t.aa), hn::Mul(weight, t.ab), hn::Mul(weight, t.bb)};
    const EdgePair first(0, 0, s.g11, t.aa), second(1, 1, s.g22, t.bb), both(0, 1, s.g12, t.ab);
    for (int i = 0, n = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j, ++n) {
            hn::Store(entry(k, first, i, j), d, out.aa[n] + part);
            hn::Store(entry(k, second, i, j), d, out.bb[n] + part);
        }
    // + turned [n]x, which is antisymmetric: (0, 1) has -z, (0, 2) y, (1, 2) -x
    const V spin[3][3] = {{zero, hn::Neg(s.normal.z), s.normal.y},
                          {s.normal.z, zero, hn::Neg(s.normal.x)},
                          {hn::Neg(s.normal.y), s.normal.x, zero}};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            hn::Store(hn::MulAdd(turned, spin[i][j], entry(k, both, i, j)), d, out.ab[3 * i + j] + part);
}

/// Stores the vectors of the three corners: those of 1 and 2, and the opposite of their sum.
HWY_INLINE void storeCorners(V3 first, V3 second, float* HWY_RESTRICT out, std::size_t part)
{
    const V zero = hn::Zero(Lanes());
    storeGroup(negative(first + second), zero, out, part);
    storeGroup(first, zero, out + 64, part);
    storeGroup(second, zero, out + 128, part);
}

HWY_INLINE void loadTangent(const MembraneTangentBlock& block, std::size_t part, V (&aa)[6], V (&ab)[9], V (&bb)[6])
{
    const Lanes d;
    for (int k = 0; k < 6; ++k) {
        aa[k] = hn::Load(d, block.aa[k] + part);
        bb[k] = hn::Load(d, block.bb[k] + part);
    }
    for (int k = 0; k < 9; ++k) ab[k] = hn::Load(d, block.ab[k] + part);
}

/// The products of the tangent with two edges.
HWY_INLINE void times(const MembraneTangentBlock& block, std::size_t part, V3 a, V3 b, V3& first, V3& second)
{
    V aa[6], ab[9], bb[6];
    loadTangent(block, part, aa, ab, bb);
    first = symmetricProduct(aa, a) +
            V3{dot({ab[0], ab[1], ab[2]}, b), dot({ab[3], ab[4], ab[5]}, b), dot({ab[6], ab[7], ab[8]}, b)};
    second = symmetricProduct(bb, b) +
             V3{dot({ab[0], ab[3], ab[6]}, a), dot({ab[1], ab[4], ab[7]}, a), dot({ab[2], ab[5], ab[8]}, a)};
}

} // namespace

HWY_ATTR void updateMembraneBlocks(std::span<const MembraneBlock> all, const BlockInput& input, linalg::Blocks blocks,
                                   const MembraneOutput& output)
{
    const float *HWY_RESTRICT x = input.x.data(), *HWY_RESTRICT v = input.v.data();
    const Lanes d;
    const V force = hn::Set(d, input.weights.force), stiffness = hn::Set(d, input.weights.stiffness);
    const V turning = hn::Set(d, input.weights.turning);
    for (int b = blocks.begin; b < blocks.end; ++b)
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            const MembraneBlock& block = all[static_cast<std::size_t>(b)];
            MembraneTangentBlock& tangent = output.tangents[static_cast<std::size_t>(b)];
            const Sheet s = sheetAt(block, x, part);
            const V weight = hn::Load(d, block.weight + part);
            const Two stress = edgeStress(s);
            writeTangent(s, stress, turning, hn::Mul(stiffness, weight), tangent, part);

            const V3 origin = gatherNodes(v, block.nodes[0] + part);
            V3 first, second;
            times(tangent, part, gatherNodes(v, block.nodes[1] + part) - origin,
                  gatherNodes(v, block.nodes[2] + part) - origin, first, second);
            const V pull = hn::Mul(force, weight);
            first = negative(first + pull * (stress.aa * s.e1 + stress.ab * s.e2));
            second = negative(second + pull * (stress.ab * s.e1 + stress.bb * s.e2));
            storeCorners(first, second, output.corners.data() + static_cast<long>(kMembraneCorners) * b, part);
            const Q4 turn = rotationBetween(loadFrame(block.frame, part), s.e1, s.normal);
            storeGroup({turn.x, turn.y, turn.z}, turn.w, output.quaternions.data() + 64l * b, part);
        }
}

HWY_ATTR void multiplyMembraneBlocks(std::span<const MembraneTangentBlock> all, const float* HWY_RESTRICT p,
                                     float* HWY_RESTRICT corners, linalg::Blocks blocks)
{
    for (int b = blocks.begin; b < blocks.end; ++b)
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            const MembraneTangentBlock& block = all[static_cast<std::size_t>(b)];
            const V3 origin = gatherNodes(p, block.nodes[0] + part);
            V3 first, second;
            times(block, part, gatherNodes(p, block.nodes[1] + part) - origin,
                  gatherNodes(p, block.nodes[2] + part) - origin, first, second);
            storeCorners(first, second, corners + static_cast<long>(kMembraneCorners) * b, part);
        }
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace filasofia::engine {

HWY_EXPORT(updateMembraneBlocks);
HWY_EXPORT(multiplyMembraneBlocks);

void updateMembranes(std::span<const MembraneBlock> membranes, const BlockInput& input, linalg::Blocks blocks,
                     const MembraneOutput& output)
{
    HWY_DYNAMIC_DISPATCH(updateMembraneBlocks)(membranes, input, blocks, output);
}

void multiplyMembranes(std::span<const MembraneTangentBlock> tangents, const linalg::NodeArray& p,
                       std::span<float> corners, linalg::Blocks blocks)
{
    HWY_DYNAMIC_DISPATCH(multiplyMembraneBlocks)(tangents, p.data(), corners.data(), blocks);
}

} // namespace filasofia::engine
#endif
