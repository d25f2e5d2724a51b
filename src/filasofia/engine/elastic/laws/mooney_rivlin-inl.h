// The law of Mooney and Rivlin (physics/elastic_law.h). Compiled once per target (Highway's foreach_target), which is
// why the guard is unusual.
#if defined(FILASOFIA_ENGINE_LAWS_MOONEY_RIVLIN_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_ENGINE_LAWS_MOONEY_RIVLIN_INL_H
#undef FILASOFIA_ENGINE_LAWS_MOONEY_RIVLIN_INL_H
#else
#define FILASOFIA_ENGINE_LAWS_MOONEY_RIVLIN_INL_H
#endif

#include "filasofia/engine/elastic/stretch_response-inl.h"
#include "filasofia/physics/elastic_law.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {

template <class S> HWY_INLINE StretchResponse<S> responseOf(const physics::MooneyRivlin& law, const S (&s)[3], S ratio)
{
    const Invariants<S> at(s);
    const S d1 = 0.5 * (1.0 - law.share), d2 = 0.5 * law.share;
    InvariantResponse<S> w;
    w.energy = d1 * (at.i1 - S(3.0)) + d2 * (at.i2 - S(3.0));
    w.d1 = d1;
    w.d2 = d2;
    return responseOf(at, w, ratio);
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
