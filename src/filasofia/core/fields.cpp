#include "filasofia/core/fields.h"

#include "filasofia/core/validate.h"

#include <cmath>

namespace filasofia {

std::string Range::text(std::string_view unit) const
{
    const std::string suffix = unit.empty() || unit == "-" ? "" : filasofia::text(" ", unit);
    const bool bounded = std::isfinite(high);
    if (!std::isfinite(low) && !bounded) return "must be finite";
    if (!bounded) return filasofia::text("must be ", lowOpen ? "> " : ">= ", low, suffix);
    if (!std::isfinite(low)) return filasofia::text("must be ", highOpen ? "< " : "<= ", high, suffix);
    return filasofia::text("must be in ", lowOpen ? "(" : "[", low, ", ", high, highOpen ? ")" : "]", suffix);
}

std::string Range::refusal(std::string_view unit, double value) const
{
    if (isAbsurd(value) && Range{low, high, lowOpen, highOpen}.contains(value)) {
        if (low < 0.0) return closed(-most, most).text(unit);
        return Range{.high = most, .highOpen = false}.text(unit);
    }
    // "must be > 0, got inf" would be no reason.
    const bool endless = std::isinf(value) && value > 0.0 && std::isfinite(low) && !std::isfinite(high);
    return text(unit) + (endless ? " and finite" : "");
}

void detail::failRange(std::string_view object, std::string_view path, const Range& range, std::string_view unit,
                       double value)
{
    fail(object, ": ", path, " ", range.refusal(unit, value), ", got ", value);
}

} // namespace filasofia
