#pragma once

#include <csignal>

namespace filasofia::runtime {

/// While it lives, Ctrl-C, SIGTERM and SIGHUP, the end of the terminal, ask for a clean end; a second one ends the
/// program at once. A SIGHUP that is ignored, as after nohup, stays so.
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
    struct sigaction hangUp_ {};
};

} // namespace filasofia::runtime
