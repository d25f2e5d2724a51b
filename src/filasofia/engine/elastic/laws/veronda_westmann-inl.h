// The law of Veronda and Westmann (physics/elastic_law.h). Compiled once per target (Highway's foreach_target), which
// is why the guard is unusual.
#if defined(FILASOFIA_ENGINE_LAWS_VERONDA_WESTMANN_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_ENGINE_LAWS_VERONDA_WESTMANN_INL_H
#undef FILASOFIA_ENGINE_LAWS_VERONDA_WESTMANN_INL_H
#else
#define FILASOFIA_ENGINE_LAWS_VERONDA_WESTMANN_INL_H
#endif

#include "filasofia/engine/elastic/stretch_response-inl.h"
#include "filasofia/physics/elastic_law.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {

template <class S>
HWY_INLINE StretchResponse<S> responseOf(const physics::VerondaWestmann& law, const S (&s)[3], S ratio)
{
    const Invariants<S> at(s);
    const S c = law.exponent;
    const Curve<S> e = boundedExponential(c * (at.i1 - S(3.0)));
    InvariantResponse<S> w;
    w.energy = (e.value - S(1.0)) / c - S(0.5) * (at.i2 - S(3.0));
    w.d1 = e.slope;
    w.d2 = -0.5;
    w.d11 = c * e.curvature;
    return responseOf(at, w, ratio);
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
