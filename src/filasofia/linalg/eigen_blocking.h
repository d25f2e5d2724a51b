#pragma once

#include <Eigen/Core>

namespace filasofia::linalg {

/// Eigen sums in blocks as long as the caches that it finds are large: on another machine, other bits. From the first
/// call on they are as long everywhere. To be called before anything dense is factorised or multiplied.
inline void fixBlocking()
{
    static const bool once = [] {
        Eigen::setCpuCacheSizes(32 << 10, 256 << 10, 2 << 20);
        return true;
    }();
    static_cast<void>(once);
}

} // namespace filasofia::linalg
