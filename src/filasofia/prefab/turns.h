#pragma once

#include "filasofia/core/guarded_call.h"
#include "filasofia/core/log.h"
#include "filasofia/core/mpsc_queue.h"

#include <atomic>
#include <functional>
#include <mutex>
#include <utility>

namespace filasofia::prefab {

/// Lets one thread at a time work on the state of a prefab, and the stepping thread wait for nobody: its work, if it
/// finds the state taken, is left to the thread that has it. So a step goes on whoever else holds the state, for
/// however long. Work may call back, on its own thread.
class Turns {
public:
    /// Does the work now or, if another thread is at it, lets that one do it. What the work throws comes through in the
    /// first case and is logged in the second.
    template <class Work> void soon(Work work)
    {
        if (!tryWork(work)) {
            left_.push(std::function<void()>(std::move(work)));
            count_.fetch_add(1, std::memory_order_acq_rel);
        }
        workOffLeft();
    }
    /// Does the work now and returns true, or not at all.
    template <class Work> bool now(Work&& work)
    {
        const bool done = tryWork(work);
        workOffLeft();
        return done;
    }
    /// Waits for its turn: for threads that may.
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
        doLeft(); // what was asked for earlier comes first
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
    /// Work that was left while its holder was ending. The exchange with oneself orders this look behind the unlocking:
    /// whoever leaves work after the look finds the state free.
    void workOffLeft()
    {
        while (count_.fetch_add(0, std::memory_order_acq_rel) > 0) {
            const std::unique_lock lock(mutex_, std::try_to_lock);
            if (!lock) return; // its holder looks when it ends
            doLeft();
        }
    }

    std::recursive_mutex mutex_;
    MpscQueue<std::function<void()>> left_; ///< read by who holds the mutex
    std::atomic<int> count_ = 0;            ///< [-] left; for a moment less than there are
};

} // namespace filasofia::prefab
