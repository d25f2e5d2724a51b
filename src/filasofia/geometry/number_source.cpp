#include "filasofia/geometry/number_source.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>

namespace filasofia::geometry {
namespace {

// Not std::isspace, which depends on the locale.
bool isSpace(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

} // namespace

std::string quoted(std::string_view word)
{
    constexpr std::size_t kMaxLength = 40;
    std::string out = "'";
    for (char c : word.substr(0, kMaxLength)) out += c >= ' ' && c <= '~' ? c : '?';
    return out + (word.size() > kMaxLength ? "...'" : "'");
}

std::string lowered(std::string_view word)
{
    std::string out(word);
    for (char& c : out)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + ('a' - 'A'));
    return out;
}

void NumberSource::skipSpace()
{
    while (at_ < bytes_.size()) {
        const char c = bytes_[at_];
        if (comments_ && c == '#') {
            at_ = std::min(bytes_.find('\n', at_), bytes_.size());
            continue;
        }
        if (!isSpace(c)) return;
        if (c == '\n') ++line_;
        ++at_;
    }
}

std::string_view NumberSource::takeWord()
{
    lastAt_ = at_, lastLine_ = line_;
    while (at_ < bytes_.size() && !isSpace(bytes_[at_]) && !(comments_ && bytes_[at_] == '#')) ++at_;
    return bytes_.substr(lastAt_, at_ - lastAt_);
}

std::string_view NumberSource::word()
{
    skipSpace();
    return takeWord();
}

std::string_view NumberSource::wordOnThisLine()
{
    const std::size_t at = at_, line = line_;
    skipSpace();
    if (line_ == line) return takeWord();
    at_ = at, line_ = line;
    return {};
}

char NumberSource::byte()
{
    lastAt_ = at_, lastLine_ = line_;
    if (at_ == bytes_.size()) failHere("the file ends too early");
    if (bytes_[at_] == '\n') ++line_;
    return bytes_[at_++];
}

void NumberSource::skipBytes(std::size_t count, std::string_view what)
{
    lastAt_ = at_;
    if (count > remaining()) failHere("the file ends before ", count, " bytes of ", what);
    at_ += count;
}

std::string_view NumberSource::textInQuotes(std::string_view what)
{
    skipSpace();
    lastLine_ = line_;
    const std::size_t end = at_ < bytes_.size() && bytes_[at_] == '"' ? bytes_.find('"', at_ + 1) : bytes_.npos;
    const std::string_view out = bytes_.substr(std::min(at_ + 1, bytes_.size()), end - at_ - 1);
    if (end == bytes_.npos || out.find('\n') != out.npos) failHere(what, " must stand between quotation marks");
    at_ = end + 1;
    return out;
}

std::string_view NumberSource::restOfLine()
{
    const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
    const std::string_view out = bytes_.substr(at_, end - at_);
    lastAt_ = at_, lastLine_ = line_;
    at_ = std::min(end + 1, bytes_.size());
    if (end < bytes_.size()) ++line_;
    return out;
}

bool NumberSource::skipPast(std::string_view text)
{
    const std::size_t found = bytes_.find(text, at_);
    if (found == std::string_view::npos) return false;
    const std::size_t end = found + text.size();
    line_ += static_cast<std::size_t>(std::ranges::count(bytes_.substr(at_, end - at_), '\n'));
    at_ = end;
    return true;
}

template <class Raw> Raw NumberSource::raw(std::string_view what)
{
    lastAt_ = at_;
    if (remaining() < sizeof(Raw)) failHere("the file ends before ", what);
    std::array<char, sizeof(Raw)> buffer;
    std::memcpy(buffer.data(), bytes_.data() + at_, sizeof(Raw));
    if (swapped_) std::ranges::reverse(buffer);
    at_ += sizeof(Raw);
    Raw value;
    std::memcpy(&value, buffer.data(), sizeof(Raw));
    return value;
}

std::int64_t NumberSource::integerIn(std::string_view word, std::string_view what) const
{
    if (word.empty()) failHere("the file ends before ", what);
    std::int64_t value = 0;
    const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (problem == std::errc::result_out_of_range) failHere(what, " must fit in 64 bits, got ", quoted(word));
    if (problem != std::errc{} || end != word.data() + word.size())
        failHere(what, " must be a whole number, got ", quoted(word));
    return value;
}

double NumberSource::realIn(std::string_view word, std::string_view what) const
{
    if (word.empty()) failHere("the file ends before ", what);
    // C's printf writes no leading plus by default, but hand-written files have it.
    const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
    double value = 0.0;
    const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (problem == std::errc::result_out_of_range) failHere(what, " must fit in a double, got ", quoted(word));
    if (problem != std::errc{} || end != digits.data() + digits.size())
        failHere(what, " must be a number, got ", quoted(word));
    if (!std::isfinite(value)) failHere(what, " must be finite, got ", quoted(word));
    return value;
}

std::int64_t NumberSource::integer(std::string_view what, int rawSize)
{
    if (!binary_) return integerIn(word(), what);
    switch (rawSize) {
    case 1:
        return raw<std::int8_t>(what);
    case 2:
        return raw<std::int16_t>(what);
    case 4:
        return raw<std::int32_t>(what);
    default:
        return raw<std::int64_t>(what);
    }
}

double NumberSource::real(std::string_view what, int rawSize)
{
    if (!binary_) return realIn(word(), what);
    const double value = rawSize == 4 ? static_cast<double>(raw<float>(what)) : raw<double>(what);
    if (!std::isfinite(value)) failHere(what, " must be finite, got ", value);
    return value;
}

double NumberSource::anyRealIn(std::string_view word) const
{
    try {
        return realIn(word, "a number");
    } catch (const Error&) {
        return std::numeric_limits<double>::quiet_NaN();
    }
}

double NumberSource::anyReal(std::string_view what, int rawSize)
{
    if (binary_) return rawSize == 4 ? static_cast<double>(raw<float>(what)) : raw<double>(what);
    const std::string_view next = word();
    if (next.empty()) failHere("the file ends before ", what);
    return anyRealIn(next);
}

void NumberSource::boundCount(std::int64_t count, std::string_view what, std::size_t numbers,
                              std::size_t rawBytes) const
{
    // As text, a number takes a digit and a space; the last space may be missing. The limit keeps the number of face
    // indices within an int.
    constexpr std::int64_t kMaxCount = 500'000'000;
    const std::size_t smallest = binary_ ? rawBytes : 2 * numbers;
    const std::size_t max = std::min<std::size_t>((remaining() + 1) / smallest, kMaxCount);
    if (count < 0 || static_cast<std::uint64_t>(count) > max)
        failHere(what, " must be in [0, ", max, "] (the rest of the file holds no more), got ", count);
}

std::size_t NumberSource::count(std::string_view what, std::size_t numbers, std::size_t rawBytes, int rawSize)
{
    const std::int64_t announced = integer(what, rawSize);
    boundCount(announced, what, numbers, rawBytes);
    return static_cast<std::size_t>(announced);
}

} // namespace filasofia::geometry
