#include "filasofia/core/hash.h"

#include <array>
#include <cinttypes>
#include <cstdio>
#include <cstring>

namespace filasofia {

void Hasher::addBytes(const unsigned char* bytes, std::size_t count)
{
    constexpr std::size_t kLanes = 8, kBlock = kLanes * sizeof(std::uint64_t);
    constexpr std::uint64_t kOdd = 0xbf58476d1ce4e5b9u; // a multiplier of splitmix64: multiplication by it can be
                                                        // inverted, as can the shift after it
    std::array<std::uint64_t, kLanes> lanes = {}, words = {};
    for (std::size_t k = 0; k < kLanes; ++k) lanes[k] = kOdd * (k + 1);
    const auto mix = [&] {
        for (std::size_t k = 0; k < kLanes; ++k) {
            const std::uint64_t product = (lanes[k] ^ words[k]) * kOdd;
            lanes[k] = product ^ (product >> 32);
        }
    };
    std::size_t at = 0;
    for (; at + kBlock <= count; at += kBlock) {
        std::memcpy(words.data(), bytes + at, kBlock);
        mix();
    }
    if (at <
        count) { // the rest of the last block is filled with zeros; the count distinguishes them from zeros in the data
        words = {};
        std::memcpy(words.data(), bytes + at, count - at);
        mix();
    }
    add(static_cast<std::uint64_t>(count));
    for (const std::uint64_t lane : lanes) add(lane);
}

std::string hexadecimal(std::uint64_t hash)
{
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016" PRIx64, hash);
    return digits;
}

} // namespace filasofia
