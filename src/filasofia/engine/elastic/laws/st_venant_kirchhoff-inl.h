// The law of St Venant and Kirchhoff (physics/elastic_law.h). Compiled once per target (Highway's foreach_target),
// which is why the guard is unusual.
#if defined(FILASOFIA_ENGINE_LAWS_ST_VENANT_KIRCHHOFF_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_ENGINE_LAWS_ST_VENANT_KIRCHHOFF_INL_H
#undef FILASOFIA_ENGINE_LAWS_ST_VENANT_KIRCHHOFF_INL_H
#else
#define FILASOFIA_ENGINE_LAWS_ST_VENANT_KIRCHHOFF_INL_H
#endif

#include "filasofia/engine/elastic/stretch_response-inl.h"
#include "filasofia/physics/elastic_law.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {

template <class S> HWY_INLINE StretchResponse<S> responseOf(const physics::StVenantKirchhoff&, const S (&s)[3], S ratio)
{
    StretchResponse<S> out;
    S e[3], sum = 0.0;
    for (int i = 0; i < 3; ++i) {
        e[i] = S(0.5) * (s[i] * s[i] - S(1.0)); // Green's strain
        sum = sum + e[i];
    }
    out.energy = e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + S(0.5) * ratio * sum * sum;
    for (int i = 0; i < 3; ++i) {
        const S stress = S(2.0) * e[i] + ratio * sum; // second Piola-Kirchhoff
        out.d[i] = stress * s[i];
        for (int j = 0; j < 3; ++j) out.h[i][j] = ratio * s[i] * s[j];
        out.h[i][i] = out.h[i][i] + stress + S(2.0) * s[i] * s[i];
    }
    return out;
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
