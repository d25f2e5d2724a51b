#pragma once

#include "filasofia/physics/physics_server.h"

#include <cstdint>
#include <string>
#include <vector>

namespace filasofia::runtime {

/// Notes the attachments and grasps of a run that held nothing, and those of which points let go. Used by the stepping
/// thread, and by others after it has ended.
class AttachmentWatch {
public:
    void begin() { *this = {}; }
    void count(const physics::StepReport& report);
    /// One line per attachment or grasp, "'liver': attachments[1] to 'wall' holds nothing: no node was there"; after
    /// twelve of them, how many more there were.
    [[nodiscard]] std::vector<std::string> nothing(const physics::PhysicsServer& physics) const;
    /// One line per attachment or grasp, "'liver': attachments[1] to 'wall' broke at 3.214 s (4.02 N)" or "'liver':
    /// attachments[1] to 'wall': 37 points let go from 1.2 s to 2.1 s (at most 0.35 N)"; after twelve of them, how many
    /// more there were.
    [[nodiscard]] std::vector<std::string> broke(const physics::PhysicsServer& physics) const;

private:
    struct Break {
        physics::AttachmentBreak all = {}; ///< its points, and the largest force, over all steps
        double first = 0.0, last = 0.0;    ///< [s] steps in which points let go
    };

    std::vector<physics::NothingHeld> nothing_; ///< the first of them
    std::uint64_t allNothing_ = 0;
    std::vector<Break> broke_; ///< in the order in which points first let go
};

} // namespace filasofia::runtime
