// Ogden's law (physics/elastic_law.h). Compiled once per target (Highway's foreach_target), which is why the guard
// is unusual.
#if defined(FILASOFIA_ENGINE_LAWS_OGDEN_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_ENGINE_LAWS_OGDEN_INL_H
#undef FILASOFIA_ENGINE_LAWS_OGDEN_INL_H
#else
#define FILASOFIA_ENGINE_LAWS_OGDEN_INL_H
#endif

#include "filasofia/engine/elastic/stretch_response-inl.h"
#include "filasofia/physics/elastic_law.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {

template <class S> HWY_INLINE StretchResponse<S> responseOf(const physics::Ogden& law, const S (&s)[3], S ratio)
{
    StretchResponse<S> out;
    const VolumeRatio<S> volume(s);
    const Curve<S> j = boundedLogarithm(volume.value, S(kSmallestVolume));
    Curve<S> own[3];
    for (int i = 0; i < 3; ++i) own[i] = boundedLogarithm(s[i], S(kSmallestStretch));
    for (const physics::OgdenTerm& term : law.terms) {
        const S alpha = term.exponent, weight = 2.0 * term.share / (term.exponent * term.exponent);
        for (int k = 0; k < 3; ++k) { // t_k^alpha = exp(y), y = alpha (ln s_k - ln J / 3)
            const Curve<S> e = boundedExponential(alpha * (own[k].value - S(1.0 / 3.0) * j.value));
            S y[3];
            for (int i = 0; i < 3; ++i)
                y[i] = alpha * ((i == k ? own[k].slope : S(0.0)) - S(1.0 / 3.0) * j.slope * volume.d[i]);
            out.energy = out.energy + weight * (e.value - S(1.0));
            for (int a = 0; a < 3; ++a) {
                out.d[a] = out.d[a] + weight * e.slope * y[a];
                for (int b = 0; b < 3; ++b) {
                    const S spherical = j.curvature * volume.d[a] * volume.d[b] + j.slope * volume.second(a, b);
                    const S second = (a == k && b == k ? own[k].curvature : S(0.0)) - S(1.0 / 3.0) * spherical;
                    out.h[a][b] = out.h[a][b] + weight * (e.curvature * y[a] * y[b] + e.slope * alpha * second);
                }
            }
        }
    }
    addVolumetric(volume, bulkRatio(ratio), out);
    return out;
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
