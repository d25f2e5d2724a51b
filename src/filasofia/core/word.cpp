#include "filasofia/core/word.h"

#include "filasofia/core/error.h"

#include <algorithm>
#include <charconv>
#include <optional>

namespace filasofia {
namespace {

constexpr std::size_t kMaxWord = 80, kMaxWordInLine = 160, kShown = 40; // bytes

std::string beginning(std::string_view word)
{
    std::size_t end = kShown;
    while (end > 0 && (static_cast<unsigned char>(word[end]) & 0xc0u) == 0x80u)
        --end; // do not cut a letter (UTF-8) in half
    return text(word.substr(0, end), "…");
}

template <class T> std::optional<T> parsed(std::string_view word)
{
    if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
    T value = {};
    const char* end = word.data() + word.size();
    const auto [stop, problem] = std::from_chars(word.data(), end, value);
    if (problem != std::errc() || stop != end) return std::nullopt;
    return value;
}

} // namespace

std::string shortened(std::string_view word) { return word.size() > kMaxWord ? beginning(word) : std::string(word); }

std::string shownWord(std::string_view word)
{
    const std::string_view quote = parsed<double>(word) ? "" : "'";
    return text(quote, shortened(word), quote);
}

std::string withShortWords(std::string_view line)
{
    std::string out;
    while (!line.empty()) {
        const std::string_view word = line.substr(0, line.find(' '));
        out += word.size() > kMaxWordInLine ? beginning(word) : std::string(word);
        line.remove_prefix(word.size());
        const std::size_t spaces = std::min(line.find_first_not_of(' '), line.size());
        out += line.substr(0, spaces);
        line.remove_prefix(spaces);
    }
    return out;
}

int wholeNumber(std::string_view name, std::string_view word, const Bound& bound)
{
    using Limits = std::numeric_limits<int>;
    Range range = bound.range; // the bounds of an int count too
    if (range.low < Limits::min()) range.low = Limits::min(), range.lowOpen = false;
    if (range.high > Limits::max()) range.high = Limits::max(), range.highOpen = false;
    const std::optional<int> value = parsed<int>(word);
    if (value && range.contains(*value)) return *value;
    const std::string bounds = range.text(bound.unit).substr(std::string_view("must be").size());
    fail(name, " must be a whole number", bounds, ", got ", shownWord(word));
}

double realNumber(std::string_view name, std::string_view word, const Bound& bound)
{
    const std::optional<double> value = parsed<double>(word);
    if (value && bound.range.contains(*value)) return *value;
    const std::string must = value ? bound.range.refusal(bound.unit, *value) : bound.range.text(bound.unit);
    fail(name, " ", must, ", got ", shownWord(word));
}

} // namespace filasofia
