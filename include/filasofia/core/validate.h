#pragma once

#include "filasofia/core/error.h"
#include "filasofia/core/fields.h"

#include <array>
#include <optional>
#include <type_traits>
#include <variant>
#include <vector>

namespace filasofia {
namespace detail {

[[noreturn]] void failRange(std::string_view object, std::string_view path, const Range& range, std::string_view unit,
                            double value);

/// How validate() visits a value; one specialisation per shape, so that shapes can be nested.
template <class T> struct Check {
    static void apply(const T& value, std::string_view object, const std::string& path, const Range& range,
                      std::string_view unit)
    {
        if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) {
            if (!range.contains(static_cast<double>(value)))
                failRange(object, path, range, unit, static_cast<double>(value));
        } else if constexpr (HasFields<T>) {
            forEachField<T>([&](const auto& each) {
                using Value = std::remove_cvref_t<decltype(value.*(each.member))>;
                const std::string inner = path.empty() ? std::string(each.name) : path + "." + std::string(each.name);
                const bool bare = each.unit.empty(); // a coordinate of a quantity with a unit
                Check<Value>::apply(value.*(each.member), object, inner,
                                    bare ? within(each.range, range.most) : each.range, bare ? unit : each.unit);
            });
        }
        // Texts, flags, enumerations and shared immutable data have no bounds.
    }
};

template <class T> struct Check<std::optional<T>> {
    static void apply(const std::optional<T>& value, std::string_view object, const std::string& path,
                      const Range& range, std::string_view unit)
    {
        if (value) Check<T>::apply(*value, object, path, range, unit);
    }
};

template <class... T> struct Check<std::variant<T...>> {
    static void apply(const std::variant<T...>& value, std::string_view object, const std::string& path,
                      const Range& range, std::string_view unit)
    {
        std::visit(
            [&](const auto& held) {
                Check<std::remove_cvref_t<decltype(held)>>::apply(held, object, path, range, unit);
            },
            value);
    }
};

template <class List> struct CheckEach {
    static void apply(const List& values, std::string_view object, const std::string& path, const Range& range,
                      std::string_view unit)
    {
        for (std::size_t i = 0; i < values.size(); ++i)
            Check<typename List::value_type>::apply(values[i], object, text(path, "[", i, "]"), range, unit);
    }
};
template <class T> struct Check<std::vector<T>> : CheckEach<std::vector<T>> {
};
template <> struct Check<std::vector<bool>> {
    static void apply(const std::vector<bool>&, std::string_view, const std::string&, const Range&, std::string_view) {}
};
template <class T, std::size_t n> struct Check<std::array<T, n>> : CheckEach<std::array<T, n>> {
};

} // namespace detail

/// Checks every number of a Def against the range in its fields() list, including nested Defs, lists and variants.
/// Throws an Error "<object>: <path of the field> must be <bound>, got <value>" for the first one that is out of range.
template <HasFields T> void validate(const T& def, std::string_view object)
{
    detail::Check<T>::apply(def, object, "", finite(), "");
}

} // namespace filasofia
