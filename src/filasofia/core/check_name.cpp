#include "filasofia/core/check_name.h"

#include "filasofia/core/error.h"

#include <cstdint>
#include <cstdio>
#include <optional>

namespace filasofia {
namespace {

/// Takes the next code point of UTF-8; none if it is none (RFC 3629).
std::optional<std::uint32_t> takePoint(std::string_view& rest)
{
    const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(rest[i])); };
    const std::uint32_t first = byte(0);
    const std::size_t length = first < 0x80 ? 1 : first >> 5 == 6 ? 2 : first >> 4 == 14 ? 3 : first >> 3 == 30 ? 4 : 0;
    if (length == 0 || length > rest.size()) return {};
    std::uint32_t point = length == 1 ? first : first & (0x7fu >> length);
    for (std::size_t i = 1; i < length; ++i) {
        if (byte(i) >> 6 != 2) return {};
        point = point << 6 | (byte(i) & 0x3fu);
    }
    rest.remove_prefix(length);
    constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000}; // a longer form than needed is none
    if (point < kLeast[length] || point > 0x10ffff || (point >= 0xd800 && point <= 0xdfff)) return {};
    return point;
}

bool isControl(std::uint32_t p) { return p < 0x20 || (p >= 0x7f && p < 0xa0) || p == 0x2028 || p == 0x2029; }
bool turns(std::uint32_t p)
{
    return p == 0x61c || p == 0x200e || p == 0x200f || (p >= 0x202a && p <= 0x202e) || (p >= 0x2066 && p <= 0x2069);
}
bool isBlank(std::uint32_t p)
{
    return p == ' ' || p == 0xa0 || p == 0xad || (p >= 0x2000 && p <= 0x200b) || p == 0x202f || p == 0x205f ||
           p == 0x2060 || p == 0x3000 || p == 0xfeff;
}

} // namespace

void checkName(std::string_view name, std::string_view object)
{
    bool visible = false;
    for (std::string_view rest = name; !rest.empty();) {
        const std::size_t at = name.size() - rest.size();
        const std::optional<std::uint32_t> point = takePoint(rest);
        if (!point) fail(object, ": name must be UTF-8, which it is not from byte ", at, " on");
        if (isControl(*point) || turns(*point)) {
            char number[16];
            std::snprintf(number, sizeof number, "U+%04X", static_cast<unsigned>(*point));
            fail(object, ": name must have no ",
                 isControl(*point) ? "control characters" : "marks that turn the direction of text", ", got ",
                 std::string_view(number), " at byte ", at);
        }
        visible = visible || !isBlank(*point);
    }
    if (!visible) fail(object, ": name must have a visible letter, got '", name, "'");
}

} // namespace filasofia
