#pragma once

#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/scene/scene.h"

#include <algorithm>

namespace filasofia::engine {

/// Number of elements, springs, triangles or edges from which several threads inside one body pay off: starting a
/// parallel loop costs as much as a hundred elements.
inline constexpr std::size_t kWorthSharing = 2000;

inline std::size_t sizeOf(const SoftModel& body)
{
    return body.elements.size() + body.springs.size() + body.shell.membranes.size() + body.rod.edges.size();
}

/// The size above which all threads work on one body: it is larger than one thread's share of all bodies and at least
/// kWorthSharing.
inline std::size_t sharedBeyond(const Scene& scene, const WorkerPool& pool)
{
    std::size_t total = 0;
    for (const SoftBody& body : scene.soft) total += sizeOf(body.model);
    return std::max(kWorthSharing, total / static_cast<std::size_t>(pool.threads()));
}

/// Calls work(body, b) for every soft body and its index: first for bodies larger than sharedBeyond(), one after the
/// other, each with all threads inside; then for the others in parallel, one thread each. `work` must not read or write
/// other bodies.
template <class Work> void forEachBody(Scene& scene, WorkerPool& pool, const Work& work)
{
    const std::size_t limit = sharedBeyond(scene, pool), count = scene.soft.size();
    const auto shared = [&](std::size_t b) { return sizeOf(scene.soft[b].model) > limit; };
    for (std::size_t b = 0; b < count; ++b)
        if (shared(b)) work(scene.soft[b], b);
    pool.run(static_cast<int>(count), [&](int body) {
        if (const auto b = static_cast<std::size_t>(body); !shared(b)) work(scene.soft[b], b);
    });
}

} // namespace filasofia::engine
