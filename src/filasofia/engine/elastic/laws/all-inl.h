// Every law by its response to the principal stretches: a new one is listed here and in physics::ElasticLaw. Compiled
// once per target (Highway's foreach_target), which is why the guard is unusual.
#if defined(FILASOFIA_ENGINE_LAWS_ALL_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_ENGINE_LAWS_ALL_INL_H
#undef FILASOFIA_ENGINE_LAWS_ALL_INL_H
#else
#define FILASOFIA_ENGINE_LAWS_ALL_INL_H
#endif

#include "filasofia/engine/elastic/laws/corotational-inl.h"
#include "filasofia/engine/elastic/laws/fung-inl.h"
#include "filasofia/engine/elastic/laws/gent-inl.h"
#include "filasofia/engine/elastic/laws/mooney_rivlin-inl.h"
#include "filasofia/engine/elastic/laws/neo_hookean-inl.h"
#include "filasofia/engine/elastic/laws/ogden-inl.h"
#include "filasofia/engine/elastic/laws/st_venant_kirchhoff-inl.h"
#include "filasofia/engine/elastic/laws/veronda_westmann-inl.h"

#include <variant>

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {

/// The response of a law, whichever it is. Not inlined: one copy of each law serves all loops.
template <class S>
HWY_NOINLINE HWY_ATTR StretchResponse<S> responseOf(const physics::ElasticLaw& law, const S (&s)[3], const S& ratio)
{
    return std::visit([&](const auto& each) HWY_ATTR { return responseOf(each, s, S(ratio)); }, law);
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
