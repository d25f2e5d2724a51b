#include "filasofia/physics/elastic_law.h"

#include "filasofia/core/error.h"

#include <cmath>
#include <limits>
#include <utility>

namespace filasofia::physics {

const std::vector<ElasticLaw>& elasticLaws()
{
    static const auto all = []<std::size_t... i>(std::index_sequence<i...>)
    {
        return std::vector{ElasticLaw(std::in_place_index<i>)...};
    }
    (std::make_index_sequence<std::variant_size_v<ElasticLaw>>());
    return all;
}

double rangeOf(const ElasticLaw& law)
{
    if (const auto* gent = std::get_if<Gent>(&law)) return kGentRange * gent->limit;
    return std::numeric_limits<double>::infinity();
}

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
