// The corotational law (physics/elastic_law.h). The step uses corotational.h instead. Compiled once per target
// (Highway's foreach_target), which is why the guard is unusual.
#if defined(FILASOFIA_ENGINE_LAWS_COROTATIONAL_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_ENGINE_LAWS_COROTATIONAL_INL_H
#undef FILASOFIA_ENGINE_LAWS_COROTATIONAL_INL_H
#else
#define FILASOFIA_ENGINE_LAWS_COROTATIONAL_INL_H
#endif

#include "filasofia/engine/elastic/stretch_response-inl.h"
#include "filasofia/physics/elastic_law.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {

template <class S> HWY_INLINE StretchResponse<S> responseOf(const physics::Corotational&, const S (&s)[3], S ratio)
{
    StretchResponse<S> out;
    const S lambda = ifLess(s[0] * s[1] * s[2], S(0.0), S(0.0), ratio); // lameAt() of corotational.h
    const S grown = s[0] + s[1] + s[2] - S(3.0);
    out.energy = S(0.5) * lambda * grown * grown;
    for (int i = 0; i < 3; ++i) {
        const S strain = s[i] - S(1.0);
        out.energy = out.energy + strain * strain;
        out.d[i] = S(2.0) * strain + lambda * grown;
        for (int j = 0; j < 3; ++j) out.h[i][j] = lambda;
        out.h[i][i] = out.h[i][i] + S(2.0);
    }
    return out;
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
