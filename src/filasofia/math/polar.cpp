#include "filasofia/math/polar.h"

#include "filasofia/math/svd.h"

namespace filasofia {
namespace {

constexpr int kMaxIterations = 12;

} // namespace

Quat polarRotation(const Mat3& f, Quat q)
{
    // With B = R^T F, a further rotation by the small vector w changes trace(R^T F) by w . g - w^T H w / 2, where g is
    // the axial vector of B - B^T and H = tr(B) I - sym(B). At the maximum, g = 0 and H is positive definite.
    const double tolerance = 1e-14 * frobeniusNorm(f);
    for (int k = 0; k < kMaxIterations; ++k) {
        const Mat3 b = transposeTimes(toMat3(q), f);
        const Vec3 g{b[2].y - b[1].z, b[0].z - b[2].x, b[1].x - b[0].y};
        const double s01 = -0.5 * (b[0].y + b[1].x), s02 = -0.5 * (b[0].z + b[2].x), s12 = -0.5 * (b[1].z + b[2].y);
        const Mat3 h{{{b[1].y + b[2].z, s01, s02}, {s01, b[0].x + b[2].z, s12}, {s02, s12, b[0].x + b[1].y}}};
        const double minor = h[0].x * h[1].y - s01 * s01, det = determinant(h);
        const double size = std::abs(trace(b)) + tolerance;
        if (!(h[0].x > 0 && minor > 1e-6 * size * size && det > 1e-9 * size * size * size)) break;
        if (lengthSquared(g) <= tolerance * tolerance) return q;
        const Vec3 half = 0.5 * (inverse(h) * g);
        q = normalized(q * Quat{1.0, half.x, half.y, half.z});
    }
    const Svd s = svd(f);
    return toQuat(s.u * transpose(s.v));
}

} // namespace filasofia
