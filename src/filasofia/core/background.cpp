#include "filasofia/core/background.h"

#include <pthread.h>
#include <sched.h>

#include <condition_variable>
#include <deque>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

namespace filasofia {

BackgroundJob::BackgroundJob(std::function<void()> work) : work_(std::move(work)) {}

bool BackgroundJob::claim() noexcept
{
    int waits = kWaits;
    return stage_.compare_exchange_strong(waits, kBegun, std::memory_order_acquire);
}

void BackgroundJob::tryRun() noexcept
{
    if (!claim()) return;
    work_();
    stage_.store(kDone, std::memory_order_release);
    stage_.notify_all();
}

void BackgroundJob::finish() noexcept
{
    tryRun();
    for (int now = stage_.load(std::memory_order_acquire); now != kDone; now = stage_.load(std::memory_order_acquire))
        stage_.wait(now, std::memory_order_acquire);
}

void BackgroundJob::drop() noexcept
{
    if (claim()) stage_.store(kDone, std::memory_order_release);
}

struct BackgroundThread::Impl {
    std::mutex mutex;
    std::condition_variable given;
    std::deque<std::shared_ptr<BackgroundJob>> jobs;
    bool stopping = false, refused = false;
    std::thread thread;

    void run()
    {
        // The thread that made this one may have real-time scheduling; nobody should have to wait behind these jobs.
        const sched_param ordinary{};
        pthread_setschedparam(pthread_self(), SCHED_OTHER, &ordinary);
        pthread_setname_np(pthread_self(), "filasofia-later");
        for (std::unique_lock lock(mutex);;) {
            given.wait(lock, [&] { return stopping || !jobs.empty(); });
            if (stopping) return;
            const std::shared_ptr<BackgroundJob> job = std::move(jobs.front());
            jobs.pop_front();
            lock.unlock();
            job->tryRun();
            lock.lock();
        }
    }
};

BackgroundThread::BackgroundThread() : impl_(std::make_unique<Impl>()) {}

BackgroundThread::~BackgroundThread()
{
    {
        const std::lock_guard lock(impl_->mutex);
        impl_->stopping = true;
    }
    impl_->given.notify_one();
    if (impl_->thread.joinable()) impl_->thread.join();
}

void BackgroundThread::submit(std::shared_ptr<BackgroundJob> job)
{
    if (impl_->refused) return; // finish() will do it
    {
        const std::lock_guard lock(impl_->mutex);
        impl_->jobs.push_back(std::move(job));
    }
    impl_->given.notify_one();
    if (impl_->thread.joinable()) return;
    try {
        impl_->thread = std::thread([impl = impl_.get()] { impl->run(); });
    } catch (const std::system_error&) {
        impl_->refused = true;
        impl_->jobs.clear();
    }
}

} // namespace filasofia
