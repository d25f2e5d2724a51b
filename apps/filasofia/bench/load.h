#pragma once

#include <time.h>

namespace filasofia::app {

/// The number of cores that other programs kept busy since construction.
class OthersLoad {
public:
    OthersLoad();
    [[nodiscard]] double cores() const; ///< [-] mean; 0 if the system does not report it

private:
    double wall_, own_, all_; ///< [s] at construction
};

/// [s] What a clock of clock_gettime() shows.
double secondsOf(clockid_t clock);

/// [s] Time of a signal from a thread on one core to a thread on another core and back. A virtual machine's cores may
/// be near each other at one time and far apart at another, which threads that share short loops feel.
double coreRoundTrip();

} // namespace filasofia::app
