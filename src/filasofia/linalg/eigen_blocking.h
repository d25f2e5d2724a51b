#pragma once

#include <Eigen/Core>

namespace filasofia::linalg {

/// Gives Eigen the same block sizes on every machine. By default they depend on the sizes of the caches that it finds,
/// and so do the bits of its sums. Call this before any dense product or factorisation.
inline void fixBlocking()
{
    static const bool once = [] {
        Eigen::setCpuCacheSizes(32 << 10, 256 << 10, 2 << 20);
        return true;
    }();
    static_cast<void>(once);
}

} // namespace filasofia::linalg
