#include "filasofia/event/wait_cycle.h"

#include <map>
#include <mutex>

namespace filasofia::event::wait_cycle {
namespace {

std::mutex mutex;
std::map<std::thread::id, std::thread::id> waitsFor; // a thread waits for one other at a time

} // namespace

bool enter(std::thread::id runner)
{
    const std::thread::id self = std::this_thread::get_id();
    const std::lock_guard lock(mutex);
    // A cycle is never entered, so this loop ends.
    for (auto at = runner; at != self;) {
        const auto next = waitsFor.find(at);
        if (next == waitsFor.end()) {
            waitsFor[self] = runner;
            return true;
        }
        at = next->second;
    }
    return false;
}

void leave(std::thread::id waiter)
{
    const std::lock_guard lock(mutex);
    waitsFor.erase(waiter);
}

} // namespace filasofia::event::wait_cycle
