#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>

namespace filasofia {

/// A 64-bit hash of a sequence of numbers, the same on every machine: for regression tests, not against attackers.
class Hasher {
public:
    void add(std::uint64_t word)
    {
        // splitmix64's finaliser (Steele, Lea, Flood 2014) over a running sum: every bit of the word affects every bit
        // of the hash.
        state_ += word + 0x9e3779b97f4a7c15u;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        state_ = z ^ (z >> 31);
    }
    /// Hashes the bits of the number: 0.0 and -0.0 differ.
    void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }

    /// Hashes the bits of a long list in eight independent running sums, because each sum waits for its own
    /// multiplication. It takes a sixth of the time of add() word by word, and gives another value.
    template <class T> void addAll(std::span<const T> list)
    {
        static_assert(std::is_trivially_copyable_v<T> && std::endian::native == std::endian::little);
        addBytes(reinterpret_cast<const unsigned char*>(list.data()), list.size_bytes());
    }

    [[nodiscard]] std::uint64_t value() const { return state_; }

private:
    void addBytes(const unsigned char* bytes, std::size_t count);

    std::uint64_t state_ = 0;
};

/// The hash as the 16 digits that recordings and reports print.
std::string hexadecimal(std::uint64_t hash);

} // namespace filasofia
