#pragma once

#include <thread>

/// Which thread waits for which thread's callback, over all dispatchers of the program. A wait that closes a cycle
/// would be a deadlock.
namespace filasofia::event::wait_cycle {

/// Records that this thread waits for `runner`. False, and nothing is recorded, if runner waits, directly or through
/// others, for this thread.
[[nodiscard]] bool enter(std::thread::id runner);

/// Removes the record: `waiter` no longer waits.
void leave(std::thread::id waiter);

} // namespace filasofia::event::wait_cycle
