#pragma once

#include "filasofia/core/guarded_call.h"
#include "filasofia/core/log.h"
#include "filasofia/core/mpsc_queue.h"

#include <atomic>
#include <functional>
#include <mutex>
#include <utility>

namespace filasofia::prefab {

/// Lets one thread at a time work on the state of a prefab, without letting the stepping thread wait: if another thread
/// holds the state, that thread does the work. So a step goes on, whoever holds the state and for however long. Work
/// may call back on its own thread.
class Turns {
public:
    /// Does the work now or, if another thread holds the state, lets that thread do it. An exception of the work is
    /// passed on in the first case and logged in the second.
    template <class Work> void soon(Work work)
    {
        if (!tryWork(work)) {
            left_.push(std::function<void()>(std::move(work)));
            count_.fetch_add(1, std::memory_order_acq_rel);
        }
        workOffLeft();
    }
    /// Does the work now and returns true, or returns false if another thread holds the state.
    template <class Work> bool now(Work&& work)
    {
        const bool done = tryWork(work);
        workOffLeft();
        return done;
    }
    /// Waits until the state is free, then does the work. Only for threads that may wait.
    template <class Work> void wait(Work&& work)
    {
        {
            const std::lock_guard lock(mutex_);
            doLeft();
            work();
        }
        workOffLeft();
    }

    /// Waits only if the calling thread may.
    template <class Work> void take(bool mayWait, Work work)
    {
        if (mayWait)
            wait(work);
        else
            soon(std::move(work));
    }

private:
    template <class Work> bool tryWork(Work& work)
    {
        const std::unique_lock lock(mutex_, std::try_to_lock);
        if (!lock) return false;
        doLeft(); // earlier work comes first
        work();
        return true;
    }
    void doLeft()
    {
        while (const auto work = left_.pop()) {
            count_.fetch_sub(1, std::memory_order_acq_rel);
            if (const auto problem = guardedCall(*work)) logError(*problem);
        }
    }
    /// Does work that was left while the holder was ending. The read-modify-write orders this check after the
    /// unlocking: a thread that leaves work after the check finds the state free.
    void workOffLeft()
    {
        while (count_.fetch_add(0, std::memory_order_acq_rel) > 0) {
            const std::unique_lock lock(mutex_, std::try_to_lock);
            if (!lock) return; // its holder checks when it ends
            doLeft();
        }
    }

    std::recursive_mutex mutex_;
    MpscQueue<std::function<void()>> left_; ///< work left by other threads; read by the thread that holds the mutex
    std::atomic<int> count_ = 0;            ///< [-] work left; briefly less than the queue holds
};

} // namespace filasofia::prefab
