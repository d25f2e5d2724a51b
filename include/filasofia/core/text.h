#pragma once

#include <charconv>
#include <concepts>
#include <string>
#include <string_view>
#include <type_traits>

namespace filasofia {
namespace detail {

inline void append(std::string& out, std::string_view text) { out += text; }
// Constrained, because a string literal converts to bool more readily than to string_view.
template <std::same_as<bool> Flag> void append(std::string& out, Flag value) { out += value ? "true" : "false"; }
template <std::same_as<char> Letter> void append(std::string& out, Letter letter) { out += letter; }
template <class Number>
requires((std::integral<Number> || std::floating_point<Number>)&&!std::same_as<Number, bool> &&
         !std::same_as<Number, char>) void append(std::string& out, Number value)
{
    char buffer[40]; // the shortest text that reads back to the same number needs at most 24
    if constexpr (std::floating_point<Number>) {
        // 100000, not 1e+05: whole numbers are written without an exponent.
        if (value > Number(-1e9) && value < Number(1e9) && value == static_cast<Number>(static_cast<long>(value))) {
            out.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, static_cast<long>(value)).ptr);
            return;
        }
    }
    out.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

} // namespace detail

/// The parts, written one after another; numbers in the shortest form that reads back to the same value.
template <class... Parts> std::string text(const Parts&... parts)
{
    std::string out;
    (detail::append(out, parts), ...);
    return out;
}

/// The text without line breaks and other control characters, so that a name chosen by a user cannot forge a second
/// line.
inline std::string oneLine(std::string line)
{
    for (char& letter : line)
        if (static_cast<unsigned char>(letter) < 0x20 || letter == 0x7f) letter = ' ';
    return line;
}

} // namespace filasofia
