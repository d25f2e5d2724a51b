#pragma once

namespace filasofia::scene {

/// Whether a time [s] has come. The time of a run is the sum of its steps, and may be a little short of it: what a file
/// says for 2 s came at 2.001 s.
inline bool hasCome(double time, double now)
{
    constexpr double kShort = 1e-6; // [s]
    return time <= now + kShort;
}

} // namespace filasofia::scene
