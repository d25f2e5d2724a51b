#pragma once

#include <thread>

/// Which thread waits for which thread's callback, over all dispatchers of the program. A wait that would close a
/// circle would never end.
namespace filasofia::event::wait_circle {

/// Notes that this thread waits for `runner`. False, and nothing is noted, where runner waits, directly or through
/// others, for this thread.
[[nodiscard]] bool enter(std::thread::id runner);

/// What `waiter` waited for has come.
void leave(std::thread::id waiter);

} // namespace filasofia::event::wait_circle
