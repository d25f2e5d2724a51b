#pragma once

#include <mutex>
#include <string>

/// What SOFA keeps once per process.
namespace filasofia::sofaengine {

/// Held while anything of SOFA runs: its factories, timers and messages are shared by all engines of a process. Whoever
/// holds it may take it again.
std::recursive_mutex& sofaMutex();

/// Makes SOFA ready, once per process, and sends its messages to our log: warnings as warnings, errors as errors, and
/// nothing else. Call it under the lock.
void startSofa();

} // namespace filasofia::sofaengine
