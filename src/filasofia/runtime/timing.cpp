#include "filasofia/runtime/timing.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::runtime {

Spread spreadOf(std::vector<double> values)
{
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const auto rank = [&](double share) {
        const auto n = static_cast<double>(values.size());
        return values[static_cast<std::size_t>(std::clamp(std::ceil(share * n) - 1.0, 0.0, n - 1.0))];
    };
    return {rank(0.5), rank(0.01), rank(0.99)};
}

Spread RunTiming::rate() const
{
    std::vector<double> rates;
    for (std::size_t i = 1; i < steps.size(); ++i)
        rates.push_back(1.0 / toSeconds(std::max<Nanoseconds>(1, steps[i].wake - steps[i - 1].wake)));
    return spreadOf(std::move(rates));
}

Spread RunTiming::cost() const
{
    std::vector<double> costs;
    for (const StepTiming& step : steps) costs.push_back(toSeconds(step.cost));
    return spreadOf(std::move(costs));
}

} // namespace filasofia::runtime
