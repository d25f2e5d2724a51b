#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <utility>

/// The one list of a Def's fields. Validation, recordings, the inspector and the bounds of command-line options read
/// it.
///
///     struct Spring { double stiffness = 100; };
///     constexpr auto fields(const Spring*)
///     {
///         return describe("Spring", field("stiffness", &Spring::stiffness, "N/m", positive(), "how stiff"));
///     }
namespace filasofia {

/// The legal values of a number. NaN lies in no range.
struct Range {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    bool lowOpen = true;
    bool highOpen = true;
    /// The largest magnitude that makes sense: a finite value beyond it is a mistake of the user's.
    double most = std::numeric_limits<double>::infinity();

    [[nodiscard]] constexpr bool contains(double value) const
    {
        return (lowOpen ? value > low : value >= low) && (highOpen ? value < high : value <= high) && !isAbsurd(value);
    }
    /// The bound as an error prints it: "must be > 0 Pa", "must be in [0, 0.5)", "must be finite".
    [[nodiscard]] std::string text(std::string_view unit) const;
    /// The bound that refuses this value: "must be > 0 Pa", "must be > 0 Pa and finite", "must be <= 1e+13 Pa".
    [[nodiscard]] std::string refusal(std::string_view unit, double value) const;

private:
    [[nodiscard]] constexpr bool isAbsurd(double value) const
    {
        constexpr double infinite = std::numeric_limits<double>::infinity();
        return (value > most && value < infinite) || (value < -most && value > -infinite);
    }
};

constexpr Range finite() { return {}; }
constexpr Range positive() { return {.low = 0.0}; }
constexpr Range nonNegative() { return {.low = 0.0, .lowOpen = false}; }
constexpr Range nonNegativeOrInfinite() { return {.low = 0.0, .lowOpen = false, .highOpen = false}; }
constexpr Range positiveOrInfinite() { return {.low = 0.0, .highOpen = false}; }
constexpr Range closed(double low, double high) { return {low, high, false, false}; }    ///< [low, high]
constexpr Range open(double low, double high) { return {low, high, true, true}; }        ///< (low, high)
constexpr Range closedOpen(double low, double high) { return {low, high, false, true}; } ///< [low, high)
constexpr Range openClosed(double low, double high) { return {low, high, true, false}; } ///< (low, high]

/// The range without finite values of a larger magnitude.
constexpr Range within(Range range, double most)
{
    if (most < range.most) range.most = most;
    return range;
}

/// The largest magnitude of a quantity, by its unit. It is far beyond what anyone means and far from overflow: a typing
/// error is refused where it is made, and not flagged steps later. Places and loads may be as large as they like, sizes
/// and limits not.
struct Largest {
    std::string_view unit;
    double value;
    bool signedToo = false; ///< also that of fields whose values may be negative
};
inline constexpr Largest kLargest[] = {{"Pa", 1e13, true},
                                       {"m/s", 1e5, true},
                                       {"m/s^2", 1e5, true},
                                       {"rad/s", 1e6, true},
                                       {"rad/s or m/s", 1e6, true},
                                       {"m", 1e9},
                                       {"m^2", 1e12},
                                       {"m^3", 1e12},
                                       {"m^3/s", 1e6},
                                       {"s", 1e12},
                                       {"kg", 1e12},
                                       {"kg/m^3", 1e7},
                                       {"N", 1e12},
                                       {"N m", 1e12},
                                       {"N m or N", 1e12},
                                       {"N/m", 1e15},
                                       {"N m/rad", 1e15},
                                       {"N s/m", 1e15},
                                       {"N m s/rad", 1e15},
                                       {"N m s or N s/m", 1e15},
                                       {"kg m^2", 1e15},
                                       {"kg m^2 or kg", 1e15},
                                       {"Pa s/m^3", 1e18},
                                       {"J", 1e12},
                                       {"J/(kg K)", 1e9},
                                       {"J/(m^3 K)", 1e15},
                                       {"J/mol", 1e9},
                                       {"W/(m K)", 1e9},
                                       {"W/(m^2 K)", 1e12}};
inline constexpr double kLargestFriction = 1e3; ///< [-], of a coefficient of friction
constexpr Range withinReason(Range range, std::string_view unit)
{
    for (const Largest& each : kLargest)
        if (each.unit == unit && (each.signedToo || range.low >= 0.0)) return within(range, each.value);
    return range;
}

/// One member of a Def: its name in files and errors, its pointer to member, its unit, its legal values and its
/// meaning.
template <class Owner, class Value> struct Field {
    std::string_view name;
    Value Owner::*member;
    std::string_view unit;
    Range range;
    std::string_view meaning;
};

template <class Owner, class Value> constexpr Field<Owner, Value>
field(std::string_view name, Value Owner::*member, std::string_view unit, Range range, std::string_view meaning)
{
    return {name, member, unit, withinReason(range, unit), meaning};
}

/// A field without unit or bound: text, flags, nested Defs.
template <class Owner, class Value>
constexpr Field<Owner, Value> field(std::string_view name, Value Owner::*member, std::string_view meaning)
{
    return {name, member, "", finite(), meaning};
}

namespace detail {
/// A list of values of different types. A tuple in its place took every source that reads Defs three seconds longer to
/// compile.
template <std::size_t place, class Value> struct Listed {
    Value value;
};
template <class Places, class... Values> struct ValueList;
template <std::size_t... places, class... Values> struct ValueList<std::index_sequence<places...>, Values...>
    : Listed<places, Values>... {
    template <class Visitor> constexpr void forEach(Visitor&& visit) const
    {
        (visit(static_cast<const Listed<places, Values>*>(this)->value), ...);
    }
};
} // namespace detail

/// The name of a type and the list of its fields.
template <class... Fields> struct Description {
    std::string_view typeName;
    detail::ValueList<std::index_sequence_for<Fields...>, Fields...> list;
};

template <class... Fields> constexpr Description<Fields...> describe(std::string_view typeName, Fields... list)
{
    return {typeName, {{list}...}};
}

/// A type with a fields() list, found by argument-dependent lookup.
template <class T>
concept HasFields = requires(const T* type)
{
    fields(type);
};

/// Calls visit(field) for every field of T, in the order of the list.
template <HasFields T, class Visitor> constexpr void forEachField(Visitor&& visit)
{
    fields(static_cast<const T*>(nullptr)).list.forEach(std::forward<Visitor>(visit));
}

} // namespace filasofia
