// How the energy of an isotropic law depends on the principal stretches. Compiled once per target (Highway's
// foreach_target), which is why the guard is unusual.
#if defined(FILASOFIA_ENGINE_STRETCH_RESPONSE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_ENGINE_STRETCH_RESPONSE_INL_H
#undef FILASOFIA_ENGINE_STRETCH_RESPONSE_INL_H
#else
#define FILASOFIA_ENGINE_STRETCH_RESPONSE_INL_H
#endif

#include "filasofia/engine/elastic/scalar-inl.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {

/// The energy W(s1, s2, s3) per volume and its derivatives, all divided by mu. S is double or Lane. The last stretch is
/// negative if the element is inverted.
template <class S> struct StretchResponse {
    HWY_INLINE StretchResponse() : energy(0.0)
    {
        for (int i = 0; i < 3; ++i) {
            d[i] = 0.0;
            for (int j = 0; j < 3; ++j) h[i][j] = 0.0;
        }
    }

    S energy;
    S d[3];    ///< dW/ds_i
    S h[3][3]; ///< d2W/ds_i ds_j, symmetric
};

/// A function and its first two derivatives.
template <class S> struct Curve {
    S value, slope, curvature;
};

/// exp(y) up to y = 8, beyond its parabola there. Tissue 3,000 times as stiff as at rest has long torn, and a step with
/// more of a spread between elements ends far from its solution: bodies were thrown apart (docs/lab/laws.md).
template <class S> HWY_INLINE Curve<S> boundedExponential(S y)
{
    const S limit = 8.0, over = larger(y - limit, S(0.0)), e = exponential(smaller(y, limit));
    return {e * (S(1.0) + over + S(0.5) * over * over), e * (S(1.0) + over), e};
}

/// x if x > low. Below that low/2 (1 + (x / low)^2), which stays positive; for x < 0, low/2. Its slope is continuous.
template <class S> HWY_INLINE S boundedBelow(S x, S low)
{
    const S r = larger(x, S(0.0)) / low;
    return ifLess(x, low, S(0.5) * low * (S(1.0) + r * r), x);
}

/// The logarithm of that.
template <class S> HWY_INLINE Curve<S> boundedLogarithm(S x, S low)
{
    const S r = larger(x, S(0.0)) / low, value = boundedBelow(x, low), slope = ifLess(x, low, r, S(1.0));
    const S curvature = ifLess(x, low, ifLess(x, S(0.0), S(0.0), S(1.0) / low), S(0.0));
    const S relative = slope / value;
    return {logarithm(value), relative, curvature / value - relative * relative};
}

constexpr double kSmallestVolume = 0.2;   // [-] J below which the bounded logarithm departs from ln J
constexpr double kSmallestStretch = 0.05; // [-] the same for a stretch

/// The reciprocal of J down to kSmallestVolume, where it goes on along its tangent, also for J < 0. This is the slope
/// of the neo-Hookean law's logarithm, which so resists longer than boundedLogarithm().
template <class S> HWY_INLINE S tangentReciprocal(S volume)
{
    const S j = larger(volume, S(kSmallestVolume));
    return S(1.0) / j - (volume - j) / (j * j);
}
/// Minus its slope.
template <class S> HWY_INLINE S reciprocalSquare(S volume)
{
    const S j = larger(volume, S(kSmallestVolume));
    return S(1.0) / (j * j);
}
/// Its integral from 1 on.
template <class S> HWY_INLINE S tangentLogarithm(S volume)
{
    const S j = larger(volume, S(kSmallestVolume)), below = (volume - j) / j;
    return logarithm(j) + below - S(0.5) * below * below;
}

/// J = s1 s2 s3 and its derivatives.
template <class S> struct VolumeRatio {
    HWY_INLINE explicit VolumeRatio(const S (&s)[3])
        : value(s[0] * s[1] * s[2]), d{s[1] * s[2], s[2] * s[0], s[0] * s[1]}, s0(s[0]), s1(s[1]), s2(s[2])
    {
    }
    HWY_INLINE S second(int i, int j) const { return i == j ? S(0.0) : i + j == 1 ? s2 : i + j == 2 ? s1 : s0; }

    S value;
    S d[3];
    S s0, s1, s2;
};

/// Adds k/2 (J - 1)^2.
template <class S> HWY_INLINE void addVolumetric(const VolumeRatio<S>& volume, S k, StretchResponse<S>& out)
{
    const S grown = volume.value - S(1.0);
    out.energy = out.energy + S(0.5) * k * grown * grown;
    for (int i = 0; i < 3; ++i) {
        out.d[i] = out.d[i] + k * grown * volume.d[i];
        for (int j = 0; j < 3; ++j)
            out.h[i][j] = out.h[i][j] + k * (volume.d[i] * volume.d[j] + grown * volume.second(i, j));
    }
}

/// K / mu, for the ratio lambda / mu.
template <class S> HWY_INLINE S bulkRatio(S ratio) { return ratio + S(2.0 / 3.0); }

/// W / mu as a function of the invariants at constant volume, i1 and i2, and its derivatives by them.
template <class S> struct InvariantResponse {
    HWY_INLINE InvariantResponse() : energy(0.0), d1(0.0), d2(0.0), d11(0.0), d12(0.0), d22(0.0) {}

    S energy, d1, d2, d11, d12, d22;
};

/// The invariants at constant volume and their derivatives by the stretches.
template <class S> struct Invariants {
    HWY_INLINE explicit Invariants(const S (&s)[3]) : volume(s)
    {
        const Curve<S> l = boundedLogarithm(volume.value, S(kSmallestVolume));
        const S a = exponential(S(-2.0 / 3.0) * l.value), b = a * a;
        const S q[3] = {s[0] * s[0], s[1] * s[1], s[2] * s[2]};
        const S sum = q[0] + q[1] + q[2], pairs = q[0] * q[1] + q[1] * q[2] + q[2] * q[0];
        i1 = a * sum;
        i2 = b * pairs;
        // The factors are exp(f ln J): their derivatives are f l' J_i, and (f l')^2 J_i J_j + f (l'' J_i J_j + l'
        // J_ij).
        const auto factor = [&](double f, int i) HWY_ATTR { return S(f) * l.slope * volume.d[i]; };
        const auto second = [&](double f, int i, int j) HWY_ATTR {
            return factor(f, i) * factor(f, j) +
                   S(f) * (l.curvature * volume.d[i] * volume.d[j] + l.slope * volume.second(i, j));
        };
        S t[3];
        for (int i = 0; i < 3; ++i) {
            t[i] = S(2.0) * s[i] * (sum - q[i]);
            d1[i] = a * (S(2.0) * s[i] + sum * factor(-2.0 / 3.0, i));
            d2[i] = b * (t[i] + pairs * factor(-4.0 / 3.0, i));
        }
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                const S own = i == j ? S(2.0) : S(0.0);
                const S tij = i == j ? S(2.0) * (sum - q[i]) : S(4.0) * s[i] * s[j];
                h1[i][j] = a * (own + S(2.0) * (s[i] * factor(-2.0 / 3.0, j) + s[j] * factor(-2.0 / 3.0, i)) +
                                sum * second(-2.0 / 3.0, i, j));
                h2[i][j] = b * (tij + t[i] * factor(-4.0 / 3.0, j) + t[j] * factor(-4.0 / 3.0, i) +
                                pairs * second(-4.0 / 3.0, i, j));
            }
    }

    VolumeRatio<S> volume;
    S i1, i2;
    S d1[3], d2[3], h1[3][3], h2[3][3];
};

/// The response of a law that is a function of i1 and i2, and k/2 (J - 1)^2.
template <class S>
HWY_INLINE StretchResponse<S> responseOf(const Invariants<S>& at, const InvariantResponse<S>& w, S ratio)
{
    StretchResponse<S> out;
    out.energy = w.energy;
    for (int i = 0; i < 3; ++i) {
        out.d[i] = w.d1 * at.d1[i] + w.d2 * at.d2[i];
        for (int j = 0; j < 3; ++j)
            out.h[i][j] = w.d1 * at.h1[i][j] + w.d2 * at.h2[i][j] + w.d11 * at.d1[i] * at.d1[j] +
                          w.d22 * at.d2[i] * at.d2[j] + w.d12 * (at.d1[i] * at.d2[j] + at.d2[i] * at.d1[j]);
    }
    addVolumetric(at.volume, bulkRatio(ratio), out);
    return out;
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
