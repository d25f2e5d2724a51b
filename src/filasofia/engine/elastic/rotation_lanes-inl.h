// The rotations of sixteen elements, as the vectorised loops of all laws share them. Compiled once per target
// (Highway's foreach_target), which is why the guards are unusual.
#ifndef FILASOFIA_ENGINE_ROTATION_LANES_ONCE
#define FILASOFIA_ENGINE_ROTATION_LANES_ONCE
#include "filasofia/engine/elastic/element_rotations.h"
#include "filasofia/linalg/node_array.h"
#include "filasofia/math/polar.h"

namespace filasofia::engine {
using linalg::kBlock;

/// Finds the rotation of one element for which Newton's method failed, unlike for its neighbours in the block: the
/// element is flattened, tangled, or has jumped. polarRotation in double precision converges from any start.
inline void rotateAlone(const float (&f)[9][kBlock], int lane, ElementRotations& q)
{
    Mat3 m;
    for (int r = 0; r < 3; ++r) m[r] = {f[3 * r][lane], f[3 * r + 1][lane], f[3 * r + 2][lane]};
    const Quat old{q.w[lane], q.x[lane], q.y[lane], q.z[lane]};
    // If the positions are not finite, the step will be rolled back: keep the old rotation.
    if (!isFinite(m[0]) || !isFinite(m[1]) || !isFinite(m[2])) return;
    Quat found = polarRotation(m, normalized(old));
    if (dot(found, old) < 0.0) found = {-found.w, -found.x, -found.y, -found.z}; // nodes sum these: no sign flips
    q.w[lane] = static_cast<float>(found.w);
    q.x[lane] = static_cast<float>(found.x);
    q.y[lane] = static_cast<float>(found.y);
    q.z[lane] = static_cast<float>(found.z);
}

} // namespace filasofia::engine
#endif

#if defined(FILASOFIA_ENGINE_ROTATION_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_ENGINE_ROTATION_LANES_INL_H
#undef FILASOFIA_ENGINE_ROTATION_LANES_INL_H
#else
#define FILASOFIA_ENGINE_ROTATION_LANES_INL_H
#endif

#include "filasofia/engine/elastic/element_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {

/// H = tr(B) I - sym(B). If B is symmetric, the eigenvalues of H are the sums of two of B's stretches.
struct StretchSums {
    V h0;                           ///< first entry of H
    V trace;                        ///< trace of B
    V c00, c01, c02, c11, c12, c22; ///< cofactors of H
    V det;                          ///< determinant of H
};
HWY_INLINE StretchSums stretchSums(const M3& b)
{
    const V minusHalf = hn::Set(Lanes(), -0.5f);
    const V h0 = hn::Add(b.m[1][1], b.m[2][2]), h1 = hn::Add(b.m[0][0], b.m[2][2]);
    const V h2 = hn::Add(b.m[0][0], b.m[1][1]);
    const V s01 = hn::Mul(minusHalf, hn::Add(b.m[0][1], b.m[1][0]));
    const V s02 = hn::Mul(minusHalf, hn::Add(b.m[0][2], b.m[2][0]));
    const V s12 = hn::Mul(minusHalf, hn::Add(b.m[1][2], b.m[2][1]));
    const V c00 = hn::MulSub(h1, h2, hn::Mul(s12, s12)), c01 = hn::MulSub(s02, s12, hn::Mul(s01, h2));
    const V c02 = hn::MulSub(s01, s12, hn::Mul(s02, h1)), c11 = hn::MulSub(h0, h2, hn::Mul(s02, s02));
    const V c12 = hn::MulSub(s01, s02, hn::Mul(h0, s12)), c22 = hn::MulSub(h0, h1, hn::Mul(s01, s01));
    return {h0, hn::Add(h0, b.m[0][0]), c00, c01, c02, c11, c12, c22, sumOfProducts(h0, c00, s01, c01, s02, c02)};
}

/// Newton's method for the rotation nearest to F (math/polar.h), lane by lane. A lane stops once its last correction is
/// so small that the next would be lost in rounding. Returns the lanes that did not converge.
HWY_INLINE hn::Mask<Lanes> nearestRotation(const M3& f, Q4& q)
{
    const Lanes d;
    const V zero = hn::Zero(d), half = hn::Set(d, 0.5f);
    auto going = hn::Eq(zero, zero);
    auto failed = hn::Ne(zero, zero);
    for (int k = 0; k < 6; ++k) {
        const M3 b = transposeTimes(matrixOf(q), f);
        // A further rotation by w changes tr(R^T F) by w . g - w^T H w / 2.
        const V3 g{hn::Sub(b.m[2][1], b.m[1][2]), hn::Sub(b.m[0][2], b.m[2][0]), hn::Sub(b.m[1][0], b.m[0][1])};
        const auto [h0, trace, c00, c01, c02, c11, c12, c22, det] = stretchSums(b);
        // The step leads to the maximum only if H is safely positive definite. If an element is shrunk to a point, the
        // products of three stretches underflow in floats.
        const V trace2 = hn::Mul(trace, trace), safe = hn::Set(d, 1e-4f);
        const auto definite =
            hn::And(hn::And(hn::Gt(h0, zero), hn::Gt(trace, hn::Set(d, 1e-9f))),
                    hn::And(hn::Gt(c22, hn::Mul(safe, trace2)), hn::Gt(det, hn::Mul(safe, hn::Mul(trace2, trace)))));
        failed = hn::Or(failed, hn::AndNot(definite, going));
        going = hn::And(going, definite);
        const V scale = hn::Div(half, hn::IfThenElse(definite, det, hn::Set(d, 1.0f)));
        const V3 w = scale * V3{dot({c00, c01, c02}, g), dot({c01, c11, c12}, g), dot({c02, c12, c22}, g)};
        const V nw = hn::NegMulAdd(q.z, w.z, hn::NegMulAdd(q.y, w.y, hn::NegMulAdd(q.x, w.x, q.w)));
        const V nx = hn::NegMulAdd(q.z, w.y, hn::MulAdd(q.y, w.z, hn::MulAdd(q.w, w.x, q.x)));
        const V ny = hn::NegMulAdd(q.x, w.z, hn::MulAdd(q.z, w.x, hn::MulAdd(q.w, w.y, q.y)));
        const V nz = hn::NegMulAdd(q.y, w.x, hn::MulAdd(q.x, w.y, hn::MulAdd(q.w, w.z, q.z)));
        const V length = hn::Sqrt(hn::MulAdd(nw, nw, sumOfProducts(nx, nx, ny, ny, nz, nz)));
        const V one = hn::Div(hn::Set(d, 1.0f), length);
        q.w = hn::IfThenElse(going, hn::Mul(nw, one), q.w);
        q.x = hn::IfThenElse(going, hn::Mul(nx, one), q.x);
        q.y = hn::IfThenElse(going, hn::Mul(ny, one), q.y);
        q.z = hn::IfThenElse(going, hn::Mul(nz, one), q.z);
        going = hn::And(going, hn::Ge(dot(w, w), hn::Set(d, 2e-8f)));
        if (hn::AllFalse(d, going)) break;
    }
    return hn::Or(failed, going);
}

HWY_INLINE void finishAlone(hn::Mask<Lanes> lanes, const M3& f, std::size_t part, ElementRotations& rotations)
{
    const Lanes d;
    alignas(64) float copy[9][kBlock];
    alignas(64) float late[kBlock];
    for (int k = 0; k < 9; ++k) hn::Store(f.m[k / 3][k % 3], d, copy[k] + part);
    hn::Store(hn::IfThenElseZero(lanes, hn::Set(d, 1.0f)), d, late + part);
    for (std::size_t l = part; l < part + kLanes; ++l)
        if (late[l] != 0.0f) rotateAlone(copy, static_cast<int>(l), rotations);
}

/// Updates the rotations of a part of a block to the deformation gradients f, and writes them to the group of
/// quaternions as well.
HWY_INLINE Q4 updateRotation(const M3& f, std::size_t part, ElementRotations& turn, float* HWY_RESTRICT quaternions)
{
    const Lanes d;
    Q4 q{hn::Load(d, turn.x + part), hn::Load(d, turn.y + part), hn::Load(d, turn.z + part),
         hn::Load(d, turn.w + part)};
    const auto late = nearestRotation(f, q);
    hn::Store(q.x, d, turn.x + part);
    hn::Store(q.y, d, turn.y + part);
    hn::Store(q.z, d, turn.z + part);
    hn::Store(q.w, d, turn.w + part);
    if (!hn::AllFalse(d, late)) {
        finishAlone(late, f, part, turn);
        q = {hn::Load(d, turn.x + part), hn::Load(d, turn.y + part), hn::Load(d, turn.z + part),
             hn::Load(d, turn.w + part)};
    }
    linalg::HWY_NAMESPACE::storeGroup({q.x, q.y, q.z}, q.w, quaternions, part);
    return q;
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
