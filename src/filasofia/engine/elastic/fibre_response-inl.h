// The response of fibres (physics::FibreFamily) to their strain, for a number and for lanes. Compiled once per target
// (Highway's foreach_target), which is why the guard is unusual.
#if defined(FILASOFIA_ENGINE_FIBRE_RESPONSE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_ENGINE_FIBRE_RESPONSE_INL_H
#undef FILASOFIA_ENGINE_FIBRE_RESPONSE_INL_H
#else
#define FILASOFIA_ENGINE_FIBRE_RESPONSE_INL_H
#endif

#include "filasofia/engine/elastic/stretch_response-inl.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {

/// The energy of a family and its derivatives by E = H : C - 1.
template <class S> struct FibreResponse {
    S energy;    ///< [Pa]
    S slope;     ///< [Pa]
    S curvature; ///< [Pa], >= 0
};

/// Slack fibres, E < 0, have only the active stress.
template <class S> HWY_INLINE FibreResponse<S> fibreResponse(S stiffness, S exponent, S active, S strain)
{
    const S zero = 0.0, half = 0.5, two = 2.0;
    const S square = strain * strain;
    const Curve<S> e = boundedExponential(exponent * square);
    const auto ifTense = [&](S value) HWY_ATTR { return ifLess(strain, zero, zero, value); };
    return {ifTense(half * stiffness / exponent * (e.value - S(1.0))) + half * active * strain,
            ifTense(stiffness * strain * e.slope) + half * active,
            ifTense(stiffness * (e.slope + two * exponent * square * e.curvature))};
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
