#pragma once

#include "filasofia/frame/frame.h"

#include <functional>
#include <vector>

namespace filasofia::prefab {

/// A strand of a thread that stands up over a place, from the node that is held down to its base.
struct StandingStrand {
    int base = 0;        ///< [-] node at its base, where it leaves the tissue
    double length = 0.0; ///< [m]
};
/// The strand from a node on towards another one, as far as it is over the place.
StandingStrand standingStrand(const frame::SoftBodyFrame& thread, int from, int to, Vec3 place, Vec3 up);

/// Which nodes of such a strand fingers take: at most so many that `wanted` picks, so far [m] from each other.
struct FingersOn {
    double apart = 0.0;
    int most = 0;
    std::function<bool(Vec3)> wanted;
};
std::vector<int> fingerNodes(const frame::SoftBodyFrame& thread, int from, const StandingStrand& strand,
                             const FingersOn& fingers);

} // namespace filasofia::prefab
