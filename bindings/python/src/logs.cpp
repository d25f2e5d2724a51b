// Lines of the log for a function of Python's.
#include "results.h"

#include "filasofia/core/log.h"

#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace filasofia::python {
namespace {

/// Lines that wait for Python. Whoever logs may hold locks of the engine, and never waits for the interpreter's: the
/// main thread takes the lines as soon as it runs Python.
struct Waiting {
    std::mutex mutex;
    std::vector<std::pair<LogLevel, std::string>> lines;
};
Waiting& waiting()
{
    static auto& made = *new Waiting; // for ever: threads may log until the process ends
    return made;
}

nb::object& receiver()
{
    static auto& made = *new nb::object; // with the interpreter's lock
    return made;
}

/// As Python's `logging` counts.
int levelOf(LogLevel level) { return level == LogLevel::Error ? 40 : level == LogLevel::Warning ? 30 : 20; }

int deliver(void*)
{
    std::vector<std::pair<LogLevel, std::string>> lines;
    {
        const std::lock_guard lock(waiting().mutex);
        lines.swap(waiting().lines);
    }
    const nb::object to = receiver(); // it may change meanwhile
    for (const auto& [level, line] : lines) {
        if (!to.is_valid()) break;
        try {
            // A line may have any bytes, such as those of the name of a file.
            to(levelOf(level),
               nb::steal(PyUnicode_DecodeUTF8(line.data(), static_cast<Py_ssize_t>(line.size()), "replace")));
        } catch (nb::python_error& problem) {
            problem.discard_as_unraisable(to);
        }
    }
    return 0;
}

void keep(LogLevel level, std::string_view line)
{
    const std::lock_guard lock(waiting().mutex);
    waiting().lines.emplace_back(level, line);
    // If the interpreter has no room for another call, one of those that wait takes this line, too.
    static_cast<void>(Py_AddPendingCall(&deliver, nullptr));
}

void logTo(nb::object function)
{
    setLogSink({});
    deliver(nullptr); // what was logged before is for whom it was logged
    if (function.is_none()) {
        receiver() = nb::object();
        return;
    }
    receiver() = std::move(function);
    setLogSink(&keep);
}

} // namespace

void bindLogs(nb::module_& module)
{
    module.def("_log_to", &logTo, nb::arg("function").none(),
               nb::sig("def _log_to(function: collections.abc.Callable[[int, str], object] | None) -> None"));
}

} // namespace filasofia::python
