#pragma once

#include "filasofia/core/fields.h"

#include <string>
#include <string_view>
#include <type_traits>

/// Words that a user typed: how an error prints them, and the numbers that they stand for.
namespace filasofia {

/// The word; if it is longer than 80 bytes, its first 40 and "…".
std::string shortened(std::string_view word);

/// The word as errors print it: a number as it is, anything else in quotes; shortened.
std::string shownWord(std::string_view word);

/// The line, in which every word (between spaces) longer than 160 bytes is cut to its first 40 and "…": a path of usual
/// length stays whole, and an endless word cannot hide what the line says.
std::string withShortWords(std::string_view line);

/// The legal values of a number and its unit.
struct Bound {
    Range range = {};
    std::string_view unit = {};
};

/// The bound that the fields() list of a Def gives for a member. If the list does not name the member, any finite
/// number is legal.
template <class Owner, class Value> constexpr Bound boundOf(Value Owner::*member)
{
    Bound bound;
    forEachField<Owner>([&](const auto& each) {
        if constexpr (std::is_same_v<decltype(each.member), Value Owner::*>)
            if (each.member == member) bound = {each.range, each.unit};
    });
    return bound;
}

/// The number that `word` spells, without anything before or after it. If it is not a number or out of bounds, throws
/// an Error "<name> must be in [0, 3600] s, got <word>" (for an int: "must be a whole number in ...").
int wholeNumber(std::string_view name, std::string_view word, const Bound& bound);
double realNumber(std::string_view name, std::string_view word, const Bound& bound);

} // namespace filasofia
