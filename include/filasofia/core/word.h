#pragma once

#include "filasofia/core/fields.h"

#include <string>
#include <string_view>
#include <type_traits>

/// Words that a user typed: how an error shows them, and the numbers they stand for.
namespace filasofia {

/// The word; of one longer than 80 bytes the first 40 and "…".
std::string shortened(std::string_view word);

/// The word as errors name it: a number as it is, anything else in quotes; shortened.
std::string shownWord(std::string_view word);

/// The line with every word (between spaces) longer than 160 bytes cut to its first 40 and "…": a path of usual length
/// stays whole, an endless one cannot hide what the line says.
std::string withShortWords(std::string_view line);

/// The legal values of a number and its unit.
struct Bound {
    Range range = {};
    std::string_view unit = {};
};

/// What the fields() list of a Def says of one of its members; a member that it does not list may be any finite number.
template <class Owner, class Value> constexpr Bound boundOf(Value Owner::*member)
{
    Bound bound;
    forEachField<Owner>([&](const auto& each) {
        if constexpr (std::is_same_v<decltype(each.member), Value Owner::*>)
            if (each.member == member) bound = {each.range, each.unit};
    });
    return bound;
}

/// The number that `word` is, without anything before or after it. Throws an Error "<name> must be in [0, 3600] s, got
/// <word>" (for an int: "must be a whole number in ...") where it is none or out of bounds.
int wholeNumber(std::string_view name, std::string_view word, const Bound& bound);
double realNumber(std::string_view name, std::string_view word, const Bound& bound);

} // namespace filasofia
