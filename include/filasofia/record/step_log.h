#pragma once

#include "filasofia/physics/step_record.h"

#include <utility>
#include <vector>

namespace filasofia::physics {
class PhysicsServer;
}

/// Records what happened, step by step, and replays it.
namespace filasofia::record {

/// The steps of one run, in memory.
class StepLog {
public:
    /// Moves all steps that the server has logged since the last call into this log, which must be the only reader of
    /// the server's log.
    void drain(physics::PhysicsServer& server);

    [[nodiscard]] const std::vector<physics::StepRecord>& steps() const { return steps_; }
    /// Moves the steps out and starts with an empty log.
    [[nodiscard]] std::vector<physics::StepRecord> take() { return std::exchange(steps_, {}); }
    /// False if a step was lost or tune() ran: later steps cannot be replayed.
    [[nodiscard]] bool replayable() const;

private:
    std::vector<physics::StepRecord> steps_;
};

} // namespace filasofia::record
