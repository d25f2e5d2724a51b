// Gent's law of limited extensibility (physics/elastic_law.h). Compiled once per target (Highway's foreach_target),
// which is why the guard is unusual.
#if defined(FILASOFIA_ENGINE_LAWS_GENT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_ENGINE_LAWS_GENT_INL_H
#undef FILASOFIA_ENGINE_LAWS_GENT_INL_H
#else
#define FILASOFIA_ENGINE_LAWS_GENT_INL_H
#endif

#include "filasofia/engine/elastic/stretch_response-inl.h"
#include "filasofia/physics/elastic_law.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {

template <class S> HWY_INLINE StretchResponse<S> responseOf(const physics::Gent& law, const S (&s)[3], S ratio)
{
    const Invariants<S> at(s);
    const S limit = law.limit, way = (at.i1 - S(3.0)) / limit;
    const S within = smaller(way, S(physics::kGentRange)), over = way - within, slope = S(1.0) / (S(1.0) - within);
    InvariantResponse<S> w;
    w.energy = S(0.5) * limit * (logarithm(slope) + slope * over * (S(1.0) + S(0.5) * slope * over));
    w.d1 = S(0.5) * slope * (S(1.0) + slope * over);
    w.d11 = S(0.5) * slope * slope / limit;
    return responseOf(at, w, ratio);
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
