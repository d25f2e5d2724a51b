#pragma once

#include "filasofia/physics/step_record.h"

#include "filasofia/frame/frame.h"

#include <span>

namespace filasofia::physics {

/// What a step is told.
struct StepInput {
    double dt = 1e-3;                   ///< [s], >= 0; 0 applies the commands and moves nothing
    std::span<Command> commands = {};   ///< applied first; what they bring is moved out of them
    std::uint32_t flags = 0;            ///< StepFlag bits the report starts with
    const StepBudget* budget = nullptr; ///< none: the step takes what it takes
};

/// The seam behind which an engine works: ours, or another one. Only build() may be called from any thread.
class PhysicsEngine {
public:
    virtual ~PhysicsEngine() = default;
    /// Checks a Def and makes the body of it; throws Error. Reads nothing that a step changes.
    [[nodiscard]] virtual std::unique_ptr<BuiltBody> build(const BodyDef& def) const = 0;
    /// One step. Never throws: what went wrong is in the report.
    virtual StepReport step(const StepInput& in) = 0;
    /// Writes the whole state into a Frame, reusing its memory.
    virtual void capture(frame::Frame& out) const = 0;
    /// Writes what the log keeps besides the report.
    virtual void record(StepRecord& out) const = 0;
    /// A hash of the state: same input, same hash, at every step. Of a soft body it sees places, velocities and every
    /// edit of its mesh; whatever else a solver keeps shows in these a step later, or never.
    [[nodiscard]] virtual std::uint64_t hash() const = 0;
};

} // namespace filasofia::physics
