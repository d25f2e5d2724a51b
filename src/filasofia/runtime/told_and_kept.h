#pragma once

#include "filasofia/runtime/memory.h"

#include <cmath>
#include <mutex>

/// What the watchers of surfaces, electrodes and ducts have in common.
namespace filasofia::runtime {

/// [s] From when on an event may tell again of what goes on, after one at `time`: once a second.
inline double nextTelling(double time)
{
    constexpr double kTelling = 1.0; // [s]
    return std::floor(time / kTelling + 1e-6) * kTelling + kTelling;
}

/// The memory of a state that a mutex guards; nothing is saved if its list `all` is empty. Both must outlive it.
template <class State> Memory memoryOf(const std::string& of, std::mutex& mutex, State& state)
{
    return {.of = of,
            .save =
                [&mutex, &state] {
                    const std::lock_guard lock(mutex);
                    return state.all.empty() ? std::any() : std::any(state);
                },
            .restore =
                [&mutex, &state](const std::any& saved) {
                    const std::lock_guard lock(mutex);
                    state = std::any_cast<const State&>(saved);
                }};
}

} // namespace filasofia::runtime
