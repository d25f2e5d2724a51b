#pragma once

#include "apps/filasofia/bench/contact_run.h"
#include "filasofia/runtime/timing.h"

#include <string>
#include <vector>

/// The scenes of `bench cut`: a blade on its way through a block of tissue.
namespace filasofia::app {

struct CutScene {
    std::string name = {};
    int cells = 16;       ///< [-] cells along x and y of the block; 4/5 of that along z
    bool touched = false; ///< if true, the block has a collision model and a second body is attached to it by springs
    double share = 0.5;   ///< [-] fraction of the block's height that the blade cuts through
    double speed = 0.05;  ///< [m/s] speed of the blade
    int repetitions = 3;  ///< [-] each with a new block
    [[nodiscard]] ContactScene make() const;
};

/// The steps of one scene, all repetitions. A step counts as cutting from the blade's first step into the block to its
/// last.
struct CutTimes {
    CutScene scene = {};
    int tetrahedra = 0;                                                         ///< [-] before the cut
    std::vector<double> topology = {}, contacts = {}, advance = {}, steps = {}; ///< [s] per step of cutting
    std::vector<double> before = {}, during = {}, after = {};                   ///< [-] iterations per step
    std::vector<double> others = {};                                            ///< [-] cores used by other programs
    double area = 0.0;                                                          ///< [m^2] area opened by one cut
    int pieces = 0;                                                             ///< pieces separated by one cut
    int edits = 0;           ///< steps that opened something, per cut
    std::uint32_t flags = 0; ///< the union over all steps
};

CutTimes timeCut(const CutScene& scene);

} // namespace filasofia::app
