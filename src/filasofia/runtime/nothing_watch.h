#pragma once

#include "filasofia/physics/physics_server.h"

#include <cstdint>
#include <string>
#include <vector>

namespace filasofia::runtime {

/// Notes the attachments and grasps of a run that held nothing. Used by the stepping thread, and by others after it has
/// ended.
class NothingWatch {
public:
    void begin() { *this = {}; }
    void count(const physics::StepReport& report);
    /// One line per attachment or grasp, "'liver': attachments[1] to 'wall' holds nothing: no node was there"; after
    /// twelve of them, how many more there were.
    [[nodiscard]] std::vector<std::string> lines(const physics::PhysicsServer& physics) const;

private:
    std::vector<physics::NothingHeld> first_;
    std::uint64_t all_ = 0;
};

} // namespace filasofia::runtime
