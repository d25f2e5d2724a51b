#pragma once

#include "filasofia/physics/step_record.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace filasofia::physics {
class PhysicsEngine;
class PhysicsServer;
} // namespace filasofia::physics

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

/// Writes one line per step as it comes: step, time, dt, flags, iterations, hash.
class StepTable {
public:
    /// Throws an Error naming the file when it cannot be written.
    explicit StepTable(const std::filesystem::path& file);
    ~StepTable();
    /// Writes all steps that the server has logged since the last time. Throws an Error when the disk is full.
    void drain(physics::PhysicsServer& server);

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

/// Makes the recorded steps again on an engine that has made none: same dt, same commands before each. Compares the
/// hash of every step that was recorded with one. Throws an Error at a step that cannot be made again.
std::optional<Difference> replay(const std::vector<physics::StepRecord>& steps, physics::PhysicsEngine& fresh);

} // namespace filasofia::record
