#pragma once

#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/model.h"

#include <algorithm>

namespace filasofia::engine {

/// Elements or springs from which on threads inside one body pay: handing a loop over costs as much as a hundred
/// elements.
inline constexpr std::size_t kWorthSharing = 2000;

/// Calls work(b) for every soft body: large ones that outweigh a thread's share one after the other, each with all
/// threads inside; then the others side by side, one thread each. Bodies must not look at each other.
template <class Work> void forEachBody(const Model& model, WorkerPool& pool, const Work& work)
{
    const auto size = [](const SoftModel& body) { return body.elements.size() + body.springs.size(); };
    std::size_t total = 0;
    for (const SoftModel& body : model.softBodies) total += size(body);
    const std::size_t share = std::max(kWorthSharing, total / static_cast<std::size_t>(pool.threads()));

    const auto shared = [&](std::size_t b) { return size(model.softBodies[b]) > share; };
    const std::size_t count = model.softBodies.size();
    for (std::size_t b = 0; b < count; ++b)
        if (shared(b)) work(b);
    pool.run(static_cast<int>(count), [&](int body) {
        if (const auto b = static_cast<std::size_t>(body); !shared(b)) work(b);
    });
}

} // namespace filasofia::engine
