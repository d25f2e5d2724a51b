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

/// Makes recorded steps again, one by one, on an engine that has made none: same dt, same commands before each. A
/// solver that had stopped at a deadline (StepFlag::OutOfTime) is told its recorded iterations in place of one; every
/// other step must come out by itself.
class Replayer {
public:
    explicit Replayer(physics::PhysicsEngine& fresh);
    /// On the engine of a server that has made no step: its frames follow, and what the server knows of the bodies.
    explicit Replayer(physics::PhysicsServer& fresh);
    ~Replayer();
    /// Makes the next step; the engine then has its state. Throws an Error naming the step that cannot be made again:
    /// where steps are missing, after tune(), or where a command is wrong.
    /// `between` is called when the step's bodies are known and before it is made.
    physics::StepReport step(const physics::StepRecord& recorded, const std::function<void()>& between = {});

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// The first step that came out differently.
struct Difference {
    std::uint64_t step = 0;
    std::uint64_t recorded = 0; ///< hash
    std::uint64_t replayed = 0; ///< hash
};

/// Makes all steps again. Compares the hash of every step that was recorded with one. Throws Error as Replayer does.
std::optional<Difference> replay(const std::vector<physics::StepRecord>& steps, physics::PhysicsEngine& fresh);

} // namespace filasofia::record
