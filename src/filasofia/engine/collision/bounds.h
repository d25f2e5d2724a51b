#pragma once

#include <cstdint>

namespace filasofia::engine {

// GCC's and Clang's vector extensions: four floats in any machine's registers, without a dispatch per box.
using FourFloats = float __attribute__((vector_size(16)));
using TwoWords = std::int64_t __attribute__((vector_size(16)));

/// A box in float: the low corner, and the high corner negated, so that merging is eight minima. The fourth components
/// are merged in the same way: they hold minus the reach of the contents (by how much a vertex may approach, plus the
/// depth), which is infinite if a vertex inside is not finite.
struct Bounds {
    FourFloats low;
    FourFloats negatedHigh;
};

inline Bounds merged(const Bounds& a, const Bounds& b)
{
    return {a.low < b.low ? a.low : b.low, a.negatedHigh < b.negatedHigh ? a.negatedHigh : b.negatedHigh};
}

/// Whether two boxes overlap or touch. A sum of floats has the sign of the exact sum, so rounding separates no boxes.
/// The fourth components are never positive and separate nothing either.
inline bool meet(const Bounds& a, const Bounds& b)
{
    const FourFloats above = a.low + b.negatedHigh, below = b.low + a.negatedHigh;
    const FourFloats largest = above > below ? above : below;
    const auto apart = reinterpret_cast<TwoWords>(largest > FourFloats{});
    return (apart[0] | apart[1]) == 0;
}

/// A box that contains nothing, overlaps nothing, and is neutral in merged().
inline Bounds emptyBounds()
{
    constexpr float kFar = 3e38f; // the sum of two of them is infinity, never a NaN
    return {FourFloats{kFar, kFar, kFar, 0.0f}, FourFloats{kFar, kFar, kFar, 0.0f}};
}

/// An empty box that marks every box it is merged with as damaged.
inline Bounds damagedBounds()
{
    Bounds out = emptyBounds();
    out.low[3] = -3e38f;
    return out;
}

inline double reachOf(const Bounds& a) { return -static_cast<double>(a.low[3]); }
inline bool damaged(const Bounds& a) { return a.low[3] < -1e38f; }
/// A measure of size, to choose which of two boxes is opened first.
inline float widthOf(const Bounds& a)
{
    const FourFloats width = a.low + a.negatedHigh;
    return width[0] * width[0] + width[1] * width[1] + width[2] * width[2];
}

} // namespace filasofia::engine
