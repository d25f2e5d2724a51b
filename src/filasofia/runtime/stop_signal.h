#pragma once

#include <csignal>

namespace filasofia::runtime {

/// While it lives, Ctrl-C and SIGTERM ask for a clean end; a second one ends the program at once.
class StopSignal {
public:
    StopSignal();
    ~StopSignal();
    StopSignal(const StopSignal&) = delete;
    StopSignal& operator=(const StopSignal&) = delete;
    [[nodiscard]] static bool received();

private:
    struct sigaction interrupt_ {};
    struct sigaction terminate_ {};
};

} // namespace filasofia::runtime
