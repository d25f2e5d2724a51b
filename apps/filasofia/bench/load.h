#pragma once

namespace filasofia::app {

/// How many cores other programs kept busy since this was made.
class OthersLoad {
public:
    OthersLoad();
    [[nodiscard]] double cores() const; ///< [-], mean; 0 where the system does not say

private:
    double wall_, own_, all_; ///< [s] when this was made
};

/// [s] How long a word takes from a thread on one core to one on another and back. A virtual machine's cores may lie
/// near each other at one time and far apart at another, and threads that share short loops feel it.
double coreRoundTrip();

} // namespace filasofia::app
