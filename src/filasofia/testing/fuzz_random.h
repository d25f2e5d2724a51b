#pragma once

#include "filasofia/core/hash.h"
#include "filasofia/math/vec3.h"

#include <cmath>
#include <cstdint>
#include <random>

namespace filasofia::testing {

/// Random numbers that are the same on every machine.
class FuzzRandom {
public:
    explicit FuzzRandom(std::uint64_t seed) : bits_(seed) {}
    double uniform(double low, double high)
    {
        return low + (high - low) * 0x1p-53 * static_cast<double>(bits_() >> 11);
    }
    int below(int count) { return static_cast<int>(bits_() % static_cast<std::uint64_t>(count)); }
    bool chance(double probability) { return uniform(0, 1) < probability; }
    Vec3 direction()
    {
        for (;;) {
            const Vec3 d{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
            if (const double l = length(d); l > 0.1 && l <= 1.0) return d / l;
        }
    }

    /// With an evenly spread logarithm.
    double logarithmic(double low, double high) { return low * std::pow(high / low, uniform(0, 1)); }

private:
    std::mt19937_64 bits_;
};

/// The seed of one scene: if it fails, it can be run again without the scenes before it.
inline std::uint64_t seedOfScene(std::uint64_t seed, std::uint64_t index)
{
    Hasher both;
    both.add(seed);
    both.add(index);
    return both.value();
}

} // namespace filasofia::testing
