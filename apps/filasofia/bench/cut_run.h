#pragma once

#include "apps/filasofia/bench/contact_run.h"
#include "filasofia/runtime/timing.h"

#include <string>
#include <vector>

/// What `bench cut` measures: a blade on its way through a block of tissue.
namespace filasofia::app {

struct CutScene {
    std::string name = {};
    int cells = 16;       ///< [-] along x and y of the block; 4/5 of them along z
    bool touched = false; ///< it has a collision model, and a second body hangs on it by springs
    double share = 0.5;   ///< [-] of the block's height that the blade cuts through
    double speed = 0.05;  ///< [m/s] of the blade
    int repetitions = 3;  ///< [-] each on a new block
    [[nodiscard]] ContactScene make() const;
};

/// Steps of one scene, all repetitions. Only those between the blade's first step into the block and its last are
/// counted as cutting.
struct CutTimes {
    CutScene scene = {};
    int tetrahedra = 0;                                                         ///< [-] at first
    std::vector<double> topology = {}, contacts = {}, advance = {}, steps = {}; ///< [s] per step of cutting
    std::vector<double> before = {}, during = {}, after = {};                   ///< [-] iterations per step
    std::vector<double> others = {};                                            ///< [-] cores that other programs took
    double area = 0.0;                                                          ///< [m^2] opened by one cut
    int pieces = 0;                                                             ///< that came loose in one cut
    int edits = 0;           ///< steps that opened something, per cut
    std::uint32_t flags = 0; ///< of all steps
};

CutTimes timeCut(const CutScene& scene);

} // namespace filasofia::app
