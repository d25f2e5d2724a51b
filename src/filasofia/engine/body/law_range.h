#pragma once

#include "filasofia/engine/elastic/element.h"
#include "filasofia/engine/elastic/stretch_law.h"
#include "filasofia/physics/elastic_law.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace filasofia::engine {

/// [-] If no principal stretch differs from 1 by more than this, i1 - 3 is within the range of the law
/// (physics::rangeOf): elements whose strain is lower need no closer look. Infinite if the law has no range. i1 is
/// convex in the logarithms of the stretches, so it is largest where each of them is highest or lowest.
inline double safeStrain(const physics::ElasticLaw& law)
{
    const double range = physics::rangeOf(law);
    if (!(range < std::numeric_limits<double>::infinity())) return range;
    const auto most = [](double strain) {
        const double high = 1.0 + strain, low = 1.0 - strain;
        return std::max((high * high + 2.0 * low * low) / std::cbrt(high * high * low * low * low * low),
                        (2.0 * high * high + low * low) / std::cbrt(high * high * high * high * low * low)) -
               3.0;
    };
    double safe = 0.0, beyond = 1.0;
    for (int i = 0; i < 30; ++i) {
        const double middle = 0.5 * (safe + beyond);
        (most(middle) < range ? safe : beyond) = middle;
    }
    constexpr double kFloat = 1.0 - 1e-4; // strains are compared in float
    return kFloat * safe;
}

/// [-] cubedInvariant() of an element.
inline double cubedInvariantOf(const FemElement& element, const Corners& x)
{
    return cubedInvariant(gradient(element, x));
}

} // namespace filasofia::engine
