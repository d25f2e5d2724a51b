#pragma once

#include <cstdint>

namespace filasofia::engine {

// GCC's and Clang's vectors: four floats in any machine's registers, without a dispatch at every box.
using FourFloats = float __attribute__((vector_size(16)));
using TwoWords = std::int64_t __attribute__((vector_size(16)));

/// A box in float, in the form in which merging is eight minima: the low corner, and the high one negated. The fourth
/// numbers are merged alike: minus the reach of what is inside (how far it may come nearer, plus the depth), endless
/// where a vertex inside is not finite.
struct Bounds {
    FourFloats low;
    FourFloats negatedHigh;
};

inline Bounds merged(const Bounds& a, const Bounds& b)
{
    return {a.low < b.low ? a.low : b.low, a.negatedHigh < b.negatedHigh ? a.negatedHigh : b.negatedHigh};
}

/// True also where the boxes only touch. A sum of floats has the sign of the exact one, so that no rounding separates.
/// The fourth numbers are never positive and separate nothing.
inline bool meet(const Bounds& a, const Bounds& b)
{
    const FourFloats above = a.low + b.negatedHigh, below = b.low + a.negatedHigh;
    const FourFloats most = above > below ? above : below;
    const auto apart = reinterpret_cast<TwoWords>(most > FourFloats{});
    return (apart[0] | apart[1]) == 0;
}

/// Holds nothing, meets nothing, and leaves what it is merged with as it was.
inline Bounds emptyBounds()
{
    constexpr float kFar = 3e38f; // two of them add up to infinity, never to a NaN
    return {FourFloats{kFar, kFar, kFar, 0.0f}, FourFloats{kFar, kFar, kFar, 0.0f}};
}

/// As an empty one; and what it is merged with is damaged.
inline Bounds damagedBounds()
{
    Bounds out = emptyBounds();
    out.low[3] = -3e38f;
    return out;
}

inline double reachOf(const Bounds& a) { return -static_cast<double>(a.low[3]); }
inline bool damaged(const Bounds& a) { return a.low[3] < -1e38f; }
/// A number to compare when one of two boxes is to be opened.
inline float widthOf(const Bounds& a)
{
    const FourFloats width = a.low + a.negatedHigh;
    return width[0] * width[0] + width[1] * width[1] + width[2] * width[2];
}

} // namespace filasofia::engine
