// The tangent of an isotropic law from its response to the principal stretches. Compiled once per target (Highway's
// foreach_target), which is why the guard is unusual.
#if defined(FILASOFIA_ENGINE_STRETCH_MODES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_ENGINE_STRETCH_MODES_INL_H
#undef FILASOFIA_ENGINE_STRETCH_MODES_INL_H
#else
#define FILASOFIA_ENGINE_STRETCH_MODES_INL_H
#endif

#include "filasofia/engine/elastic/stretch_response-inl.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {

/// The squared size of the off-diagonal entries, relative to the diagonal, up to which a matrix counts as diagonal.
HWY_INLINE double negligible(double) { return 1e-32; }
HWY_INLINE Lane negligible(Lane) { return Lane(1e-15); }
/// True if a <= 0 in every lane.
HWY_INLINE bool nonePositive(double a) { return a <= 0.0; }
HWY_INLINE bool nonePositive(Lane a)
{
    const linalg::HWY_NAMESPACE::Lanes d;
    return hn::AllFalse(d, hn::Gt(a.v, hn::Zero(d)));
}

/// One rotation of Jacobi's method in the plane of axes p and q (Golub and Van Loan 2013, section 8.5): a = J^T a J,
/// v = v J. A lane whose `left` is not positive keeps its matrices: what it computes does not depend on its neighbours.
template <int p, int q, class S> HWY_INLINE void rotateJacobi(S left, S (&a)[3][3], S (&v)[3][3])
{
    constexpr int r = 3 - p - q;
    const auto set = [&](S now, S& entry) HWY_ATTR { entry = ifLess(S(0.0), left, now, entry); };
    const S d = a[q][q] - a[p][p], two = S(2.0) * a[p][q];
    const S root = squareRoot(d * d + two * two);
    const S size = magnitude(d) + root;
    const S tangent = ifLess(d, S(0.0), -two, two) / ifLess(S(0.0), size, size, S(1.0));
    const S c = S(1.0) / squareRoot(tangent * tangent + S(1.0)), s = tangent * c;
    const S shift = tangent * a[p][q];
    set(a[p][p] - shift, a[p][p]);
    set(a[q][q] + shift, a[q][q]);
    set(S(0.0), a[p][q]);
    const S rp = a[r][p], rq = a[r][q];
    set(c * rp - s * rq, a[r][p]);
    set(s * rp + c * rq, a[r][q]);
    a[q][p] = a[p][q];
    a[p][r] = a[r][p];
    a[q][r] = a[r][q];
    for (int k = 0; k < 3; ++k) {
        const S x = v[k][p], y = v[k][q];
        set(c * x - s * y, v[k][p]);
        set(s * x + c * y, v[k][q]);
    }
}

/// Makes the symmetric matrix a diagonal; v gets its eigenvectors as columns, a rotation.
template <class S> HWY_NOINLINE HWY_ATTR void diagonalise(S (&a)[3][3], S (&v)[3][3])
{
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) v[i][j] = i == j ? 1.0 : 0.0;
    for (int sweep = 0; sweep < 12; ++sweep) { // in floats three to five are enough
        const S off = a[0][1] * a[0][1] + a[0][2] * a[0][2] + a[1][2] * a[1][2];
        const S left = off - negligible(off) * (a[0][0] * a[0][0] + a[1][1] * a[1][1] + a[2][2] * a[2][2]);
        if (nonePositive(left)) return;
        rotateJacobi<0, 1>(left, a, v);
        rotateJacobi<0, 2>(left, a, v);
        rotateJacobi<1, 2>(left, a, v);
    }
}

/// The stretches of F = R S and their axes: S = v diag(s) v^T, F = (R v) diag(s) v^T.
template <class S> struct Stretches {
    S s[3];
    S v[3][3];
};
/// `sym` is R^T F.
template <class S> HWY_INLINE Stretches<S> stretchesOf(const S (&sym)[3][3])
{
    S a[3][3];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) a[i][j] = S(0.5) * (sym[i][j] + sym[j][i]);
    Stretches<S> out;
    diagonalise(a, out.v);
    for (int i = 0; i < 3; ++i) out.s[i] = a[i][i];
    return out;
}

/// The second derivative of the energy in the axes of the stretches (Smith, de Goes and Kim 2019, "Analytic
/// eigensystems for isotropic distortion energies"), made positive semi-definite: with dF = u h v^T and dP = u p v^T,
///     p_ii = sum_j a_ij h_jj,   p_ij = ahead_k h_ij + across_k h_ji   for i, j and k different.
template <class S> struct StretchModes {
    S a[3][3];
    S ahead[3], across[3];
};

/// A symmetric matrix with the magnitudes of its eigenvalues. Without its negative ones, only the mass of a node would
/// resist where the law softens, and a step would go far beyond what it is good for.
template <class S> HWY_INLINE void project(S (&a)[3][3])
{
    S d[3][3], v[3][3];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) d[i][j] = a[i][j];
    diagonalise(d, v);
    const S e[3] = {magnitude(d[0][0]), magnitude(d[1][1]), magnitude(d[2][2])};
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j)
            a[i][j] = a[j][i] = v[i][0] * e[0] * v[j][0] + v[i][1] * e[1] * v[j][1] + v[i][2] * e[2] * v[j][2];
}

/// `turning` weighs the resistance to rotation within the step, which is that of the stress.
template <class S>
HWY_NOINLINE HWY_ATTR StretchModes<S> modesOf(const StretchResponse<S>& w, const S (&s)[3], const S& turning)
{
    // [-] Stretches as near as this to each other count as equal: the quotient of their differences would be rounding.
    constexpr double kEqual = 1e-3;
    StretchModes<S> out;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) out.a[i][j] = w.h[i][j];
    project(out.a);
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        const S apart = s[i] - s[j], size = magnitude(s[i]) + magnitude(s[j]) + S(1e-9);
        const S near = S(0.5) * (w.h[i][i] + w.h[j][j]) - w.h[i][j];
        const S isNear = magnitude(apart) - S(kEqual) * size; // negative if so
        const S quotient = (w.d[i] - w.d[j]) / ifLess(isNear, S(0.0), S(1.0), apart);
        const S flip = larger(ifLess(isNear, S(0.0), near, quotient), S(0.0));
        const S sum = larger(s[i] + s[j], S(0.01) * size);
        const S twist = turning * larger((w.d[i] + w.d[j]) / sum, S(0.0));
        out.ahead[k] = S(0.5) * (flip + twist);
        out.across[k] = S(0.5) * (flip - twist);
    }
    return out;
}

/// p of a given h.
template <class S> HWY_INLINE void modesTimes(const StretchModes<S>& modes, const S (&h)[3][3], S (&p)[3][3])
{
    for (int i = 0; i < 3; ++i) p[i][i] = modes.a[i][0] * h[0][0] + modes.a[i][1] * h[1][1] + modes.a[i][2] * h[2][2];
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        p[i][j] = modes.ahead[k] * h[i][j] + modes.across[k] * h[j][i];
        p[j][i] = modes.ahead[k] * h[j][i] + modes.across[k] * h[i][j];
    }
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
