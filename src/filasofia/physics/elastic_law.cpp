#include "filasofia/physics/elastic_law.h"

#include "filasofia/core/error.h"

#include <cmath>

namespace filasofia::physics {

void check(const ElasticLaw& law, const std::string& object)
{
    const auto* ogden = std::get_if<Ogden>(&law);
    if (!ogden) return;
    constexpr std::size_t kMostTerms = 4;
    constexpr double kRounding = 1e-6; // shares may come from decimal fractions
    if (ogden->terms.empty() || ogden->terms.size() > kMostTerms)
        fail(object, ".terms must have 1 to ", kMostTerms, " entries, got ", ogden->terms.size());
    double sum = 0.0;
    for (std::size_t i = 0; i < ogden->terms.size(); ++i) {
        if (ogden->terms[i].exponent == 0.0) fail(object, ".terms[", i, "].exponent must not be 0");
        sum += ogden->terms[i].share;
    }
    if (!(std::abs(sum - 1.0) < kRounding)) fail(object, ".terms: the shares must add up to 1, got ", sum);
}

} // namespace filasofia::physics
