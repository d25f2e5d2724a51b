#include "filasofia/geometry/array_bytes.h"

#include <cstdint>

namespace filasofia::geometry {
namespace {

constexpr std::string_view kSymbols = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

} // namespace

// Four symbols make three bytes, fewer by one for each '='. Anything else ends the data.
void ArrayBytes::decodeFour()
{
    std::uint32_t bits = 0;
    int symbols = 0, padding = 0;
    while (symbols < 4) {
        const std::size_t next = text_.find_first_not_of(" \t\r\n");
        const char c = next == std::string_view::npos ? '\0' : text_[next];
        const std::size_t value = kSymbols.find(c);
        const bool pads = c == '=' && symbols >= 2;
        if (c == '\0' || (value == std::string_view::npos && !pads) || (padding > 0 && !pads)) {
            text_ = {};
            return;
        }
        text_.remove_prefix(next + 1);
        bits = bits << 6u | (pads ? 0u : static_cast<std::uint32_t>(value));
        padding += pads ? 1 : 0;
        ++symbols;
    }
    for (int k = 0; k < 3 - padding; ++k)
        decoded_ += static_cast<char>(bits >> (16u - 8u * static_cast<unsigned>(k)) & 0xffu);
}

std::string_view ArrayBytes::take(std::size_t count)
{
    if (!base64_) {
        const std::string_view found = text_.substr(0, count);
        text_.remove_prefix(found.size());
        return found;
    }
    while (decoded_.size() < count && !text_.empty()) decodeFour();
    taken_ = decoded_.substr(0, count);
    decoded_.erase(0, count);
    return taken_;
}

} // namespace filasofia::geometry
