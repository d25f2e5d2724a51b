// One spelling for a double and for a vector of floats, so that a law is written once. Compiled once per target
// (Highway's foreach_target), which is why the guard is unusual.
#if defined(FILASOFIA_ENGINE_SCALAR_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FILASOFIA_ENGINE_SCALAR_INL_H
#undef FILASOFIA_ENGINE_SCALAR_INL_H
#else
#define FILASOFIA_ENGINE_SCALAR_INL_H
#endif

#include "filasofia/linalg/simd-inl.h"

#include <hwy/contrib/math/math-inl.h>

#include <algorithm>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Numbers side by side, one per element, with the operators of a number.
struct Lane {
    Lane() = default; // trivial: a constructor that the compiler writes would not have the target's instructions
    HWY_INLINE Lane(double all) // NOLINT(google-explicit-constructor): a constant is the same in every lane
        : v(hn::Set(linalg::HWY_NAMESPACE::Lanes(), static_cast<float>(all)))
    {
    }
    HWY_INLINE explicit Lane(linalg::HWY_NAMESPACE::V lanes) : v(lanes) {}

    friend HWY_INLINE Lane operator+(Lane a, Lane b) { return Lane(hn::Add(a.v, b.v)); }
    friend HWY_INLINE Lane operator-(Lane a, Lane b) { return Lane(hn::Sub(a.v, b.v)); }
    friend HWY_INLINE Lane operator*(Lane a, Lane b) { return Lane(hn::Mul(a.v, b.v)); }
    friend HWY_INLINE Lane operator/(Lane a, Lane b) { return Lane(hn::Div(a.v, b.v)); }
    friend HWY_INLINE Lane operator-(Lane a) { return Lane(hn::Neg(a.v)); }

    linalg::HWY_NAMESPACE::V v;
};

HWY_INLINE double squareRoot(double a) { return std::sqrt(a); }
HWY_INLINE Lane squareRoot(Lane a) { return Lane(hn::Sqrt(a.v)); }
HWY_INLINE double exponential(double a) { return std::exp(a); }
HWY_INLINE Lane exponential(Lane a) { return Lane(hn::CallExp(linalg::HWY_NAMESPACE::Lanes(), a.v)); }
HWY_INLINE double logarithm(double a) { return std::log(a); }
HWY_INLINE Lane logarithm(Lane a) { return Lane(hn::CallLog(linalg::HWY_NAMESPACE::Lanes(), a.v)); }
HWY_INLINE double magnitude(double a) { return std::abs(a); }
HWY_INLINE Lane magnitude(Lane a) { return Lane(hn::Abs(a.v)); }
HWY_INLINE double smaller(double a, double b) { return std::min(a, b); }
HWY_INLINE Lane smaller(Lane a, Lane b) { return Lane(hn::Min(a.v, b.v)); }
HWY_INLINE double larger(double a, double b) { return std::max(a, b); }
HWY_INLINE Lane larger(Lane a, Lane b) { return Lane(hn::Max(a.v, b.v)); }
/// `yes` if a < b, otherwise `no`.
HWY_INLINE double ifLess(double a, double b, double yes, double no) { return a < b ? yes : no; }
HWY_INLINE Lane ifLess(Lane a, Lane b, Lane yes, Lane no)
{
    return Lane(hn::IfThenElse(hn::Lt(a.v, b.v), yes.v, no.v));
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
