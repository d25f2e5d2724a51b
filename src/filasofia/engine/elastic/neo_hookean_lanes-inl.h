// The stable neo-Hookean law (neo_hookean.h) in lanes. Compiled once per target (Highway's foreach_target), which is
// why the guard is unusual.
#if defined(FILASOFIA_ENGINE_NEO_HOOKEAN_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_ENGINE_NEO_HOOKEAN_LANES_INL_H
#undef FILASOFIA_ENGINE_NEO_HOOKEAN_LANES_INL_H
#else
#define FILASOFIA_ENGINE_NEO_HOOKEAN_LANES_INL_H
#endif

#include "filasofia/engine/elastic/law_lanes-inl.h"
#include "filasofia/engine/elastic/neo_hookean.h"
#include "filasofia/engine/elastic/stretch_response-inl.h"
#include "filasofia/physics/elastic_law.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {

/// largestStretch() of neo_hookean.cpp, but not zero.
HWY_INLINE V largestStretch(const M3& f, const M3& r)
{
    const Lanes d;
    M3 s = transposeTimes(r, f);
    const V mean = hn::Mul(lane(1.0f / 3.0f), hn::Add(hn::Add(s.m[0][0], s.m[1][1]), s.m[2][2]));
    V square = hn::Zero(d);
    for (int k = 0; k < 9; ++k) {
        const V entry = k % 4 == 0 ? hn::Sub(s.m[k / 3][k % 3], mean) : s.m[k / 3][k % 3];
        square = hn::MulAdd(entry, entry, square);
    }
    return hn::Max(lane(1e-6f), hn::MulAdd(lane(0.81649658f), hn::Sqrt(square), hn::Abs(mean)));
}

/// NeoHookeanTangent of sixteen elements: shear by the products of the gradients, bulk by the normals of the faces,
/// twist by how these turn. With the edges e_k, J = det(g) det(e): dJ/de_0 = det(g) e_1 x e_2, and so on.
struct NeoHookeanLanes {
    using Block = NeoHookeanBlock;
    V3 e[3];   ///< [-] edges times the steepness of the gradients: no product of lengths overflows
    V gram[6]; ///< shear g_i . g_j: 00 01 02 11 12 22
    V bulk, twist;

    static HWY_INLINE NeoHookeanLanes load(const Block& block, std::size_t part)
    {
        NeoHookeanLanes lanes;
        loadGradients(block.edges, part, lanes.e);
        for (int k = 0; k < 6; ++k) lanes.gram[k] = hn::Load(Lanes(), block.gram[k] + part);
        lanes.bulk = hn::Load(Lanes(), block.bulk + part);
        lanes.twist = hn::Load(Lanes(), block.twist + part);
        return lanes;
    }
    HWY_INLINE void store(Block& block, std::size_t part) const
    {
        storeRows(e, block.edges, part);
        for (int k = 0; k < 6; ++k) hn::Store(gram[k], Lanes(), block.gram[k] + part);
        hn::Store(bulk, Lanes(), block.bulk + part);
        hn::Store(twist, Lanes(), block.twist + part);
    }
    HWY_INLINE void times(const V3 (&de)[3], V3 (&out)[3]) const
    {
        const V3 normals[3] = {cross(e[1], e[2]), cross(e[2], e[0]), cross(e[0], e[1])};
        const V grown =
            hn::Mul(bulk, hn::Add(dot(normals[0], de[0]), hn::Add(dot(normals[1], de[1]), dot(normals[2], de[2]))));
        const V3 turned[3] = {cross(de[1], e[2]) + cross(e[1], de[2]), cross(de[2], e[0]) + cross(e[2], de[0]),
                              cross(de[0], e[1]) + cross(e[0], de[1])};
        constexpr int kEntry[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
        for (int k = 0; k < 3; ++k) {
            const V a = gram[kEntry[k][0]], b = gram[kEntry[k][1]], c = gram[kEntry[k][2]];
            const V3 shear{sumOfProducts(a, de[0].x, b, de[1].x, c, de[2].x),
                           sumOfProducts(a, de[0].y, b, de[1].y, c, de[2].y),
                           sumOfProducts(a, de[0].z, b, de[1].z, c, de[2].z)};
            out[k] = shear + (grown * normals[k] + twist * turned[k]);
        }
    }
    /// The twist turns nothing back that a single node does.
    HWY_INLINE void addDiagonal(DiagonalLanes& to) const
    {
        const V3 normals[3] = {cross(e[1], e[2]), cross(e[2], e[0]), cross(e[0], e[1])};
        const FourVectors all(normals);
        V shear[4];
        diagonalOfEdges(gram, shear);
        for (int k = 0; k < 4; ++k) to.add(k, shear[k], bulk, all.v[k]);
    }
};

HWY_INLINE NeoHookeanLanes linearise(const physics::NeoHookean&, const LaneElement& at, V3 (&forces)[3])
{
    const Lanes d;
    const V one = lane(1.0f), third = lane(1.0f / 3.0f);
    NeoHookeanLanes tangent;
    V(&gram)[6] = tangent.gram;
    const V3(&g)[3] = at.g;
    gram[0] = dot(g[0], g[0]);
    gram[1] = dot(g[0], g[1]);
    gram[2] = dot(g[0], g[2]);
    gram[3] = dot(g[1], g[1]);
    gram[4] = dot(g[1], g[2]);
    gram[5] = dot(g[2], g[2]);
    // Edges are scaled by the steepness; then dJ/de_k = det(g) / steep^2 n_k.
    const V steep = hn::Sqrt(hn::Mul(third, hn::Add(gram[0], hn::Add(gram[3], gram[5]))));
    const V perSteep = hn::Div(one, steep);
    const V flat = hn::Mul(hn::Mul(dot(g[0], cross(g[1], g[2])), perSteep), hn::Mul(perSteep, perSteep));
    const V toNormal = hn::Mul(flat, steep);
    for (int k = 0; k < 3; ++k) tangent.e[k] = steep * at.edges[k];
    const V3(&e)[3] = tangent.e;
    const V3 normals[3] = {cross(e[1], e[2]), cross(e[2], e[0]), cross(e[0], e[1])};
    const V volume = hn::Mul(flat, dot(e[0], normals[0]));
    V square = hn::Zero(d); // |C|^2, of the cofactor by rows
    const V3 rows[3] = {{at.f.m[0][0], at.f.m[0][1], at.f.m[0][2]},
                        {at.f.m[1][0], at.f.m[1][1], at.f.m[1][2]},
                        {at.f.m[2][0], at.f.m[2][1], at.f.m[2][2]}};
    for (int k = 0; k < 3; ++k) {
        const V3 c = cross(rows[(k + 1) % 3], rows[(k + 2) % 3]);
        square = hn::Add(square, dot(c, c));
    }

    // In units of mu, as in neoHookeanTangent().
    const V bulk = hn::Add(at.ratio, reciprocalSquare(Lane(volume)).v);
    const V exact = hn::MulSub(at.ratio, hn::Sub(volume, one), tangentReciprocal(Lane(volume)).v);
    const V s = largestStretch(at.f, at.r);
    const auto tense = hn::Ge(hn::Sub(volume, one), lane(static_cast<float>(kTense)));
    const V twisting = hn::IfThenElse(tense, exact, hn::Min(exact, hn::Neg(one)));
    const V factor =
        hn::Min(one, hn::Add(dot(rows[0], rows[0]), hn::Add(dot(rows[1], rows[1]), dot(rows[2], rows[2]))));
    const V least = hn::MulAdd(hn::Mul(third, bulk), square, factor);
    const V lowest = hn::Neg(hn::Div(hn::Min(factor, hn::Mul(lane(0.5f), least)), s));
    const V covered = hn::Max(factor, hn::Mul(lane(static_cast<float>(kTwistCovered)), hn::Mul(s, twisting)));
    const V shear = hn::MulAdd(at.turning, hn::Sub(covered, factor), factor);
    const V twist = hn::MulAdd(at.turning, hn::Sub(hn::Max(twisting, lowest), lowest), lowest);
    const V scaled = hn::Mul(at.mu, at.force), along = hn::Mul(scaled, hn::Mul(exact, toNormal));
    const V stretching = hn::Mul(scaled, factor);
    for (int k = 0; k < 3; ++k) forces[k] = stretching * times(at.f, g[k]) + along * normals[k];

    const V weight = hn::Mul(at.mu, at.stiffness);
    for (V& each : gram) each = hn::Mul(hn::Mul(weight, shear), each);
    tangent.bulk = hn::Mul(hn::Mul(weight, bulk), hn::Mul(toNormal, toNormal));
    tangent.twist = hn::Mul(hn::Mul(weight, twist), hn::Mul(toNormal, steep)); // d2J = det(g) / steep^2 steep de x e
    return tangent;
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
