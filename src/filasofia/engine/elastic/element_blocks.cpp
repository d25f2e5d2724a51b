#include "filasofia/engine/elastic/element_blocks.h"

#include "filasofia/engine/elastic/corotational.h"
#include "filasofia/linalg/simd_targets.h"
#include "filasofia/math/polar.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filasofia/engine/elastic/element_blocks.cpp"
#include <hwy/foreach_target.h>

#include "filasofia/engine/elastic/element_lanes-inl.h"

#ifndef FILASOFIA_ENGINE_ELEMENT_BLOCKS_ONCE
#define FILASOFIA_ENGINE_ELEMENT_BLOCKS_ONCE
namespace filasofia::engine {

/// Finds the rotation of one element for which Newton's method failed, unlike for its neighbours in the block: the
/// element is flattened, tangled, or has jumped. polarRotation in double precision converges from any start.
inline void rotateAlone(const float (&f)[9][kBlock], int lane, ElementRotations& q)
{
    Mat3 m;
    for (int r = 0; r < 3; ++r) m[r] = {f[3 * r][lane], f[3 * r + 1][lane], f[3 * r + 2][lane]};
    const Quat old{q.w[lane], q.x[lane], q.y[lane], q.z[lane]};
    if (!isFinite(m[0]) || !isFinite(m[1]) || !isFinite(m[2]))
        return; // the step will be rolled back: keep the old
                // rotation
    Quat found = polarRotation(m, normalized(old));
    if (dot(found, old) < 0.0) found = {-found.w, -found.x, -found.y, -found.z}; // nodes sum these: no sign flips
    q.w[lane] = static_cast<float>(found.w);
    q.x[lane] = static_cast<float>(found.x);
    q.y[lane] = static_cast<float>(found.y);
    q.z[lane] = static_cast<float>(found.z);
}

} // namespace filasofia::engine
#endif

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

/// geometricStiffness() / mu (corotational.h) for the lanes in tension.
HWY_INLINE V geometricRatio(const M3& f, const M3& r, V tension, hn::Mask<Lanes> tense)
{
    const Lanes d;
    const V one = hn::Set(d, 1.0f), two = hn::Set(d, 2.0f);
    M3 s = transposeTimes(r, f);
    const V size = hn::Add(hn::Add(s.m[0][0], s.m[1][1]), s.m[2][2]);
    const V scale = hn::Div(one, hn::IfThenElse(tense, size, one)); // avoids overflow in the products of floats
    for (int k = 0; k < 9; ++k) s.m[k / 3][k % 3] = hn::Mul(scale, s.m[k / 3][k % 3]);
    const V least = hn::Max(hn::Set(d, static_cast<float>(kFlattest)), stretchSums(s).det);
    return hn::IfThenElseZero(tense, hn::Add(one, hn::Mul(scale, hn::Div(hn::Sub(tension, two), least))));
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

/// The three columns of a 3 x 3 stress applied to warped gradients. `h` is the gradient of the multiplied vector with
/// respect to the rotated and scaled rest shape.
HWY_INLINE void warpedStress(const M3& h, V ratio, V turning, const V3 (&b)[3], V3 (&out)[3])
{
    const V volumetric = hn::Mul(ratio, hn::Add(hn::Add(h.m[0][0], h.m[1][1]), h.m[2][2]));
    const V xx = hn::Add(twice(h.m[0][0]), volumetric), yy = hn::Add(twice(h.m[1][1]), volumetric);
    const V zz = hn::Add(twice(h.m[2][2]), volumetric);
    const V more = hn::Add(hn::Set(Lanes(), 1.0f), turning), less = hn::Sub(hn::Set(Lanes(), 1.0f), turning);
    const auto entry = [&](V ahead, V behind) HWY_ATTR { return hn::MulAdd(more, ahead, hn::Mul(less, behind)); };
    const V xy = entry(h.m[0][1], h.m[1][0]), yx = entry(h.m[1][0], h.m[0][1]);
    const V xz = entry(h.m[0][2], h.m[2][0]), zx = entry(h.m[2][0], h.m[0][2]);
    const V yz = entry(h.m[1][2], h.m[2][1]), zy = entry(h.m[2][1], h.m[1][2]);
    for (int k = 0; k < 3; ++k) out[k] = {dot({xx, xy, xz}, b[k]), dot({yx, yy, yz}, b[k]), dot({zx, zy, zz}, b[k])};
}

HWY_ATTR void updateElementBlocks(std::span<const ElementBlock> all, const BlockInput& input, linalg::Blocks blocks,
                                  const ElementOutput& output)
{
    const ElementBlock* HWY_RESTRICT elements = all.data();
    const float *HWY_RESTRICT x = input.x.data(), *HWY_RESTRICT v = input.v.data();
    ElementRotations* HWY_RESTRICT rotations = output.rotations.data();
    WarpedBlock* HWY_RESTRICT warped = output.warped.data();
    float *HWY_RESTRICT corners = output.corners.data(), *HWY_RESTRICT quaternions = output.quaternions.data();
    const Lanes d;
    const V force = hn::Set(d, input.weights.force), stiffness = hn::Set(d, input.weights.stiffness);
    const V turningWeight = hn::Set(d, input.weights.turning), two = hn::Set(d, 2.0f);
    for (int block = blocks.begin; block < blocks.end; ++block)
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            const ElementBlock& element = elements[block];
            V3 edges[3], g[3];
            loadEdges(x, element.nodes, part, edges);
            loadGradients(element.gradients, part, g);
            const M3 f = gradientOf(edges, g);

            ElementRotations& turn = rotations[block];
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
            storeGroup({q.x, q.y, q.z}, q.w, quaternions + 64l * block, part);

            // The first Piola-Kirchhoff stress P = 2 mu (F - R) + lambda (tr(R^T F) - 3) R puts -V P g_k on the nodes.
            const M3 r = matrixOf(q);
            // An inverted element resists shear only (lameAt in corotational.h).
            const auto inverted = hn::Lt(determinant(f), hn::Zero(d));
            const V mu = hn::Load(d, element.mu + part);
            const V ratio = hn::IfThenZeroElse(inverted, hn::Load(d, element.ratio + part));
            const V lambda = hn::Mul(ratio, mu);
            V stretch = hn::Set(d, -3.0f);
            for (int k = 0; k < 9; ++k) stretch = hn::MulAdd(r.m[k / 3][k % 3], f.m[k / 3][k % 3], stretch);
            const V shear = hn::Mul(hn::Mul(two, mu), force), bulk = hn::Mul(hn::Mul(lambda, stretch), force);
            M3 stress;
            for (int k = 0; k < 9; ++k)
                stress.m[k / 3][k % 3] =
                    hn::MulAdd(shear, hn::Sub(f.m[k / 3][k % 3], r.m[k / 3][k % 3]), hn::Mul(bulk, r.m[k / 3][k % 3]));

            WarpedBlock& out = warped[block];
            hn::Store(ratio, d, out.ratio + part);
            const V tension = hn::Mul(ratio, stretch);
            const auto tense = hn::And(hn::Gt(tension, two), hn::Gt(stretch, hn::Set(d, static_cast<float>(kTense))));
            V turning = hn::Zero(d);
            if (!hn::AllFalse(d, tense)) turning = hn::Mul(turningWeight, geometricRatio(f, r, tension, tense));
            hn::Store(turning, d, out.turning + part);
            const V root = hn::Sqrt(hn::Mul(mu, stiffness));
            V3 b[3];
            for (int k = 0; k < 3; ++k) {
                b[k] = root * times(r, g[k]);
                hn::Store(b[k].x, d, out.gradients[3 * k] + part);
                hn::Store(b[k].y, d, out.gradients[3 * k + 1] + part);
                hn::Store(b[k].z, d, out.gradients[3 * k + 2] + part);
            }
            loadEdges(v, element.nodes, part, edges);
            V3 kv[3], total[3];
            warpedStress(gradientOf(edges, b), ratio, turning, b, kv);
            for (int k = 0; k < 3; ++k) total[k] = negative(times(stress, g[k]) + kv[k]);
            storeCorners(total, corners + static_cast<long>(kElementCorners) * block, part);
        }
}

HWY_ATTR void multiplyElementBlocks(const WarpedBlock* HWY_RESTRICT warped, const float* HWY_RESTRICT p,
                                    float* HWY_RESTRICT corners, linalg::Blocks blocks)
{
    const Lanes d;
    for (int block = blocks.begin; block < blocks.end; ++block)
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            V3 edges[3], b[3], out[3];
            loadEdges(p, warped[block].nodes, part, edges);
            loadGradients(warped[block].gradients, part, b);
            warpedStress(gradientOf(edges, b), hn::Load(d, warped[block].ratio + part),
                         hn::Load(d, warped[block].turning + part), b, out);
            storeCorners(out, corners + static_cast<long>(kElementCorners) * block, part);
        }
}

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

HWY_EXPORT(updateElementBlocks);
HWY_EXPORT(multiplyElementBlocks);
HWY_EXPORT(updateSpringBlocks);
HWY_EXPORT(multiplySpringBlocks);

void updateElements(std::span<const ElementBlock> elements, const BlockInput& input, linalg::Blocks blocks,
                    const ElementOutput& output)
{
    HWY_DYNAMIC_DISPATCH(updateElementBlocks)(elements, input, blocks, output);
}

void multiplyElements(std::span<const WarpedBlock> warped, const linalg::NodeArray& p, std::span<float> corners,
                      linalg::Blocks blocks)
{
    HWY_DYNAMIC_DISPATCH(multiplyElementBlocks)(warped.data(), p.data(), corners.data(), blocks);
}

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
