#pragma once

#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/model.h"

namespace filasofia::engine {

/// Calls work(b) for every soft body: those that outweigh a thread's share one after the other, each with all threads
/// inside; then the others side by side, one thread each. Bodies must not look at each other.
template <class Work> void forEachBody(const Model& model, WorkerPool& pool, const Work& work)
{
    const auto size = [](const SoftModel& body) { return body.elements.size() + body.springs.size(); };
    std::size_t total = 0;
    for (const SoftModel& body : model.softBodies) total += size(body);
    const std::size_t share = total / static_cast<std::size_t>(pool.threads());

    const std::size_t count = model.softBodies.size();
    for (std::size_t b = 0; b < count; ++b)
        if (size(model.softBodies[b]) > share) work(b);
    pool.run(static_cast<int>(count), [&](int b) {
        if (size(model.softBodies[static_cast<std::size_t>(b)]) <= share) work(static_cast<std::size_t>(b));
    });
}

} // namespace filasofia::engine
