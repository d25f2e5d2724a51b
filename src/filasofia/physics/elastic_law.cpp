#include "filasofia/physics/elastic_law.h"

#include "filasofia/core/error.h"

#include <cmath>

namespace filasofia::physics {

std::string_view nameOf(const ElasticLaw& law)
{
    return std::visit([](const auto& each) { return fields(&each).typeName; }, law);
}

void check(const ElasticLaw& law, const std::string& object)
{
    constexpr double kLeastStiffening = 0.2; // below, skin that is pulled in two directions loses all stress
    if (const auto* skin = std::get_if<VerondaWestmann>(&law); skin && !(skin->exponent >= kLeastStiffening))
        fail(object, ".exponent must be in [", kLeastStiffening, ", 100], got ", skin->exponent);
    const auto* ogden = std::get_if<Ogden>(&law);
    if (!ogden) return;
    constexpr std::size_t kMostTerms = 4;
    constexpr double kLeastExponent = 0.01; // below, rounding in float would be a hundredth of mu
    constexpr double kRounding = 1e-6;      // shares may come from decimal fractions
    if (ogden->terms.empty() || ogden->terms.size() > kMostTerms)
        fail(object, ".terms must have 1 to ", kMostTerms, " entries, got ", ogden->terms.size());
    double sum = 0.0;
    for (std::size_t i = 0; i < ogden->terms.size(); ++i) {
        if (std::abs(ogden->terms[i].exponent) < kLeastExponent)
            fail(object, ".terms[", i, "].exponent must be at least ", kLeastExponent, " or at most -", kLeastExponent,
                 ", got ", ogden->terms[i].exponent);
        sum += ogden->terms[i].share;
    }
    if (!(std::abs(sum - 1.0) < kRounding)) fail(object, ".terms: the shares must add up to 1, got ", sum);
}

} // namespace filasofia::physics
