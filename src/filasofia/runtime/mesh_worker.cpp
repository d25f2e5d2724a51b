#include "filasofia/runtime/mesh_worker.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"

#include <algorithm>
#include <iterator>

namespace filasofia::runtime {

MeshResult prepareMesh(const MeshJob& job)
{
    const SharedSurface to = job.to ? job.to : job.opening->on(*job.boundary);
    geometry::check(to->surface, text("body '", job.name, "'")); // an empty surface cannot be drawn at any level
    const auto with = [&](int subdivision) {
        return MeshResult{.surface = to,
                          .mesh = visual::PreparedMesh(to->surface, subdivision, job.name),
                          .subdivision = subdivision,
                          .transfers = {mapping::transferBetween(job.from->surface, to->surface)}};
    };
    try {
        return with(job.subdivision);
    } catch (const Error& problem) {
        if (job.subdivision == 0) throw;
        logWarning(problem.what(), "; it is drawn without subdivision");
        return with(0);
    }
}

MeshWorker::~MeshWorker()
{
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
}

void MeshWorker::ask(SurfaceKey key, MeshJob job)
{
    const std::lock_guard lock(mutex_);
    Surface& surface = surfaces_[key];
    if (!surface.newest) surface.newest = job.from;
    surface.waiting = std::move(job);
    if (!thread_.joinable()) thread_ = std::thread([this] { work(); });
    changed_.notify_all();
}

std::optional<MeshResult> MeshWorker::take(SurfaceKey key,
                                           const std::function<bool(const mapping::MappedSurface&)>& fits)
{
    const std::lock_guard lock(mutex_);
    const auto found = surfaces_.find(key);
    if (found == surfaces_.end() || !found->second.done || !fits(*found->second.done->surface)) return std::nullopt;
    return std::exchange(found->second.done, std::nullopt);
}

void MeshWorker::finish()
{
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] {
        return std::ranges::none_of(surfaces_,
                                    [](const auto& each) { return each.second.waiting || each.second.working; });
    });
}

void MeshWorker::forget(SurfaceKey key)
{
    const std::lock_guard lock(mutex_);
    const auto found = surfaces_.find(key);
    if (found == surfaces_.end()) return;
    const bool working = found->second.working;
    surfaces_.erase(found);
    if (working) surfaces_[key] = {.working = true, .forgotten = true};
    changed_.notify_all();
}

std::map<SurfaceKey, MeshWorker::Surface>::iterator MeshWorker::nextJob()
{
    // Round robin after the surface served last: a body that is cut in every frame must not keep the others waiting.
    const auto waits = [](const auto& each) { return each.second.waiting.has_value(); };
    const auto after = surfaces_.upper_bound(served_);
    const auto next = std::find_if(after, surfaces_.end(), waits);
    return next != surfaces_.end() ? next : std::ranges::find_if(surfaces_, waits);
}

void MeshWorker::put(Surface& surface, MeshResult result)
{
    surface.newest = result.surface;
    // An untaken result is replaced, but its transfers are kept: paint still passes through them.
    if (surface.done)
        result.transfers.insert(result.transfers.begin(), std::make_move_iterator(surface.done->transfers.begin()),
                                std::make_move_iterator(surface.done->transfers.end()));
    surface.done = std::move(result);
}

void MeshWorker::work()
{
    std::unique_lock lock(mutex_);
    for (;;) {
        changed_.wait(lock, [this] { return stop_ || nextJob() != surfaces_.end(); });
        if (stop_) return;
        const auto next = nextJob();
        const SurfaceKey key = served_ = next->first;
        MeshJob job = *std::exchange(next->second.waiting, std::nullopt);
        job.from = next->second.newest;
        next->second.working = true;

        lock.unlock();
        std::optional<MeshResult> result;
        try {
            result = prepare_(job);
        } catch (const std::exception& problem) { // the old triangles stay and still follow their nodes
            logError("new triangles of '", job.name, "': ", problem.what());
        }
        lock.lock();

        const auto worked = surfaces_.find(key); // forget() keeps a surface that is at work
        worked->second.working = false;
        const bool forgotten = std::exchange(worked->second.forgotten, false);
        if (forgotten && !worked->second.waiting)
            surfaces_.erase(worked);
        else if (result && !forgotten)
            put(worked->second, std::move(*result));
        changed_.notify_all();
    }
}

} // namespace filasofia::runtime
