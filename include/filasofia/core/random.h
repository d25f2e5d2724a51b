#pragma once

#include <cstdint>
#include <random>

namespace filasofia {

/// Random numbers for scenes and motions: the same seed gives the same ones with every compiler and library. The
/// distributions of <random> do not: what they make of a generator's numbers is each library's own.
class Random {
public:
    explicit Random(std::uint64_t seed) : source_(seed) {}

    /// One of the 1,001 numbers that divide [low, high] equally, both ends among them.
    double between(double low, double high)
    {
        return low + (high - low) * static_cast<double>(source_() % 1001) / 1000.0;
    }
    /// A whole number in [0, count). `count` must be > 0.
    int below(int count) { return static_cast<int>(source_() % static_cast<std::uint64_t>(count)); }
    /// True once in `count` times.
    bool onceIn(int count) { return below(count) == 0; }

private:
    std::mt19937_64 source_;
};

} // namespace filasofia
