#pragma once

#include <functional>
#include <mutex>
#include <string>
#include <vector>

/// What SOFA keeps once per process.
namespace filasofia::sofaengine {

/// Held while anything of SOFA runs: its factories, timers and messages are shared by all engines of a process. Whoever
/// holds it may take it again.
std::recursive_mutex& sofaMutex();

/// Makes SOFA ready, once per process, and sends its messages to our log: warnings as warnings, errors as errors, and
/// nothing else. Call it under the lock.
void startSofa();

/// Runs what may throw anything. False, with a line in the log that begins with `what`, if it threw.
bool attempt(const std::string& what, const std::function<void()>& act);
/// The message of the exception that is being handled.
std::string problemNow();

/// While it exists, SOFA's errors are kept here and not logged. One at a time, under the lock.
class CollectErrors {
public:
    CollectErrors();
    ~CollectErrors();
    CollectErrors(const CollectErrors&) = delete;
    CollectErrors& operator=(const CollectErrors&) = delete;
    [[nodiscard]] const std::vector<std::string>& messages() const { return messages_; }

private:
    std::vector<std::string> messages_;
};

} // namespace filasofia::sofaengine
