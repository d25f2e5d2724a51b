// Fung's exponential law (physics/elastic_law.h). Compiled once per target (Highway's foreach_target), which is why the
// guard is unusual.
#if defined(FILASOFIA_ENGINE_LAWS_FUNG_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_ENGINE_LAWS_FUNG_INL_H
#undef FILASOFIA_ENGINE_LAWS_FUNG_INL_H
#else
#define FILASOFIA_ENGINE_LAWS_FUNG_INL_H
#endif

#include "filasofia/engine/elastic/stretch_response-inl.h"
#include "filasofia/physics/elastic_law.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {

template <class S> HWY_INLINE StretchResponse<S> responseOf(const physics::Fung& law, const S (&s)[3], S ratio)
{
    const Invariants<S> at(s);
    const S b = law.exponent;
    const Curve<S> e = boundedExponential(b * (at.i1 - S(3.0)));
    InvariantResponse<S> w;
    w.energy = S(0.5) * (e.value - S(1.0)) / b;
    w.d1 = S(0.5) * e.slope;
    w.d11 = S(0.5) * b * e.curvature;
    return responseOf(at, w, ratio);
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
