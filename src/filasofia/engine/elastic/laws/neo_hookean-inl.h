// The stable neo-Hookean law (physics/elastic_law.h). The step uses neo_hookean.h instead. Compiled once per target
// (Highway's foreach_target), which is why the guard is unusual.
#if defined(FILASOFIA_ENGINE_LAWS_NEO_HOOKEAN_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_ENGINE_LAWS_NEO_HOOKEAN_INL_H
#undef FILASOFIA_ENGINE_LAWS_NEO_HOOKEAN_INL_H
#else
#define FILASOFIA_ENGINE_LAWS_NEO_HOOKEAN_INL_H
#endif

#include "filasofia/engine/elastic/stretch_response-inl.h"
#include "filasofia/physics/elastic_law.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {

template <class S> HWY_INLINE StretchResponse<S> responseOf(const physics::NeoHookean&, const S (&s)[3], S ratio)
{
    StretchResponse<S> out;
    const VolumeRatio<S> volume(s);
    addVolumetric(volume, ratio, out);
    const S square = s[0] * s[0] + s[1] * s[1] + s[2] * s[2], factor = smaller(square, S(1.0));
    const S shape = ifLess(square, S(1.0), S(0.5) * (square * square + S(1.0)), square);
    const S slope = tangentReciprocal(volume.value), curvature = reciprocalSquare(volume.value);
    out.energy = out.energy + S(0.5) * (shape - S(3.0)) - tangentLogarithm(volume.value);
    for (int i = 0; i < 3; ++i) {
        out.d[i] = out.d[i] + factor * s[i] - slope * volume.d[i];
        out.h[i][i] = out.h[i][i] + factor;
        for (int j = 0; j < 3; ++j)
            out.h[i][j] = out.h[i][j] + curvature * volume.d[i] * volume.d[j] - slope * volume.second(i, j) +
                          ifLess(square, S(1.0), S(2.0) * s[i] * s[j], S(0.0));
    }
    return out;
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
