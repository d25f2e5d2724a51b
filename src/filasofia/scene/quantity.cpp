#include "filasofia/scene/quantity.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>

namespace filasofia::scene {
namespace {

// The dimensions that units are made of. An angle is one of its own: "N m" is no "N m/rad".
enum Dimension : std::size_t { Metre, Kilogram, Second, Radian, Candela, Lux, Pixel, kDimensions };

/// A unit in base units: its scale and the exponents of its dimensions.
struct Unit {
    Scale scale;
    std::array<int, kDimensions> powers = {};
};

struct Symbol {
    std::string_view name;
    Unit unit;
    bool prefixed = false; ///< whether prefixes such as k may stand before it
};

constexpr Unit unit(double factor, std::array<int, kDimensions> powers, double divisor = 1.0)
{
    return {{factor, divisor}, powers};
}

const Symbol kSymbols[] = {
    {"m", unit(1, {1}), true},
    {"kg", unit(1, {0, 1})},
    {"g", unit(1e-3, {0, 1}), true},
    {"s", unit(1, {0, 0, 1}), true},
    {"min", unit(60, {0, 0, 1})},
    {"rad", unit(1, {0, 0, 0, 1}), true},
    {"deg", unit(std::numbers::pi, {0, 0, 0, 1}, 180)},
    {"cd", unit(1, {0, 0, 0, 0, 1}), true},
    {"lx", unit(1, {0, 0, 0, 0, 0, 1}), true},
    {"px", unit(1, {0, 0, 0, 0, 0, 0, 1})},
    {"N", unit(1, {1, 1, -2}), true},
    {"Pa", unit(1, {-1, 1, -2}), true},
    {"mmHg", unit(133.322387415, {-1, 1, -2})},
    {"cmH2O", unit(98.0665, {-1, 1, -2})},
    {"bar", unit(1e5, {-1, 1, -2}), true},
    {"J", unit(1, {2, 1, -2}), true},
    {"W", unit(1, {2, 1, -3}), true},
    {"Hz", unit(1, {0, 0, -1}), true},
    {"l", unit(1e-3, {3}), true},
    {"%", unit(1, {}, 100)},
    {"1", unit(1, {})},
    {"-", unit(1, {})},
};

struct Prefix {
    std::string_view name;
    double factor;
};
constexpr Prefix kPrefixes[] = {{"k", 1e3},  {"M", 1e6},  {"G", 1e9},       {"c", 1e-2},
                                {"m", 1e-3}, {"u", 1e-6}, {"\u00b5", 1e-6}, {"n", 1e-9}};

std::optional<Unit> symbolNamed(std::string_view name)
{
    for (const Symbol& symbol : kSymbols)
        if (symbol.name == name) return symbol.unit;
    for (const Prefix& prefix : kPrefixes) {
        if (!name.starts_with(prefix.name)) continue;
        for (const Symbol& symbol : kSymbols)
            if (symbol.prefixed && symbol.name == name.substr(prefix.name.size())) {
                Unit unit = symbol.unit;
                unit.scale.factor *= prefix.factor;
                return unit;
            }
    }
    return std::nullopt;
}

void multiply(Unit& product, const Unit& by, int power)
{
    for (int i = 0; i < std::abs(power); ++i) {
        (power > 0 ? product.scale.factor : product.scale.divisor) *= by.scale.factor;
        (power > 0 ? product.scale.divisor : product.scale.factor) *= by.scale.divisor;
    }
    for (std::size_t i = 0; i < kDimensions; ++i) product.powers[i] += power * by.powers[i];
}

/// One symbol with its exponent: "m^3", "s^-2".
bool multiplyTerm(std::string_view term, bool below, Unit& product)
{
    int power = 1;
    if (const auto hat = term.find('^'); hat != std::string_view::npos) {
        const std::string_view digits = term.substr(hat + 1);
        const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), power);
        if (problem != std::errc{} || end != digits.data() + digits.size() || power == 0 || std::abs(power) > 9)
            return false;
        term = term.substr(0, hat);
    }
    const auto found = symbolNamed(term);
    if (found) multiply(product, *found, below ? -power : power);
    return found.has_value();
}

/// "kg m^2/s": terms that are multiplied, and after a slash those that divide.
std::optional<Unit> parseUnit(std::string_view text)
{
    Unit product;
    for (bool below = false;; below = true) {
        const auto slash = text.find('/');
        std::string_view terms = text.substr(0, slash);
        bool any = false;
        while (!terms.empty()) {
            const auto gap = terms.find(' ');
            if (gap != 0) {
                if (!multiplyTerm(terms.substr(0, gap), below, product)) return std::nullopt;
                any = true;
            }
            terms = gap == std::string_view::npos ? std::string_view() : terms.substr(gap + 1);
        }
        if (!any) return std::nullopt;
        if (slash == std::string_view::npos) return product;
        if (below) return std::nullopt; // "a/b/c" can be read in two ways
        text = text.substr(slash + 1);
    }
}

std::string_view withoutBlanks(std::string_view text)
{
    const auto first = text.find_first_not_of(' ');
    return first == std::string_view::npos ? std::string_view()
                                           : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

} // namespace

std::optional<Quantity> parseQuantity(std::string_view text)
{
    Quantity out;
    text = withoutBlanks(text);
    while (!text.empty() && !(text.starts_with("1/") && !out.values.empty())) { // the unit "1/s"
        double value = 0.0;
        const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (problem != std::errc{} || !std::isfinite(value)) break; // also "inf" and "nan", which are words
        out.values.push_back(value);
        text = withoutBlanks(text.substr(static_cast<std::size_t>(end - text.data())));
    }
    if (out.values.empty()) return std::nullopt;
    out.unit = text;
    return out;
}

std::optional<Scale> convert(std::string_view from, std::string_view to)
{
    const auto given = parseUnit(from);
    if (!given) return std::nullopt;
    while (!to.empty()) {
        const auto next = to.find(" or ");
        const auto wanted = parseUnit(to.substr(0, next));
        if (wanted && wanted->powers == given->powers)
            return Scale{given->scale.factor * wanted->scale.divisor, given->scale.divisor * wanted->scale.factor};
        to = next == std::string_view::npos ? std::string_view() : to.substr(next + 4);
    }
    return std::nullopt;
}

std::string nearestUnit(std::string_view wrong)
{
    const auto small = [](std::string_view text) {
        std::string out(text);
        std::ranges::transform(out, out.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        return out;
    };
    if (parseUnit(wrong)) return {}; // it is a unit, of something else
    const std::string wanted = small(wrong);
    for (const Symbol& symbol : kSymbols) {
        if (small(symbol.name) == wanted) return std::string(symbol.name);
        for (const Prefix& prefix : kPrefixes)
            if (const std::string name = std::string(prefix.name) + std::string(symbol.name);
                symbol.prefixed && small(name) == wanted)
                return name;
    }
    return {};
}

} // namespace filasofia::scene
