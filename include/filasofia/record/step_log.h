#pragma once

#include "filasofia/physics/step_record.h"

#include <utility>
#include <vector>

namespace filasofia::physics {
class PhysicsServer;
}

/// What happened, step by step, and making it happen again.
namespace filasofia::record {

/// The steps of one run, in memory.
class StepLog {
public:
    /// Takes over all steps that the server has logged since the last time. The server's log has one reader: this.
    void drain(physics::PhysicsServer& server);

    [[nodiscard]] const std::vector<physics::StepRecord>& steps() const { return steps_; }
    /// Hands the steps over and starts anew.
    [[nodiscard]] std::vector<physics::StepRecord> take() { return std::exchange(steps_, {}); }
    /// False when a step was lost or tune() ran: what follows cannot be made again.
    [[nodiscard]] bool replayable() const;

private:
    std::vector<physics::StepRecord> steps_;
};

} // namespace filasofia::record
