#pragma once

#include "filasofia/physics/step_record.h"

#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace filasofia::physics {
class PhysicsEngine;
class PhysicsServer;
} // namespace filasofia::physics

namespace filasofia::record {

/// Replays recorded steps, one by one, on an engine that has made no step: same dt, same commands before each. A solver
/// that had stopped at a deadline (StepFlag::OutOfTime) gets its recorded number of iterations instead; every other
/// step must come out the same by itself.
class Replayer {
public:
    explicit Replayer(physics::PhysicsEngine& fresh);
    /// Replays on the engine of a server that has made no step: its frames and its knowledge of the bodies are updated.
    explicit Replayer(physics::PhysicsServer& fresh);
    ~Replayer();
    /// Replays the next step; the engine then has its state. Throws an Error naming a step that cannot be replayed: if
    /// steps are missing, after tune(), or if a command is invalid.
    /// `between` is called when the step's bodies are known, before the step is computed.
    physics::StepReport step(const physics::StepRecord& recorded, const std::function<void()>& between = {});

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// The first step with a different result.
struct Difference {
    std::uint64_t step = 0;
    std::uint64_t recorded = 0; ///< hash
    std::uint64_t replayed = 0; ///< hash
};

/// Replays all steps and compares the hash of every step that was recorded with one. Throws an Error as Replayer does.
std::optional<Difference> replay(const std::vector<physics::StepRecord>& steps, physics::PhysicsEngine& fresh);

} // namespace filasofia::record
