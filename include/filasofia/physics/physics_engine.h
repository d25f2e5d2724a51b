#pragma once

#include "filasofia/core/error.h"
#include "filasofia/physics/mechanical_energy.h"
#include "filasofia/physics/step_record.h"

#include "filasofia/frame/frame.h"

#include <span>
#include <string>

namespace filasofia::physics {

/// What an engine is, and what it promises.
struct EngineInfo {
    std::string name = {};    ///< as --engine takes it: "native"
    std::string version = {}; ///< of the engine
    bool repeatable = false;  ///< the same input gives the same hash at every step, in every process
    bool deadline = false;    ///< its solvers stop at the deadline of a step
    bool cuts = false;        ///< blades cut its bodies, and stress tears them
    bool joints = false;      ///< its rigid bodies may have joints
    bool energies = false;    ///< it tells the mechanical energy of its bodies
};

/// The input of a step.
struct StepInput {
    double dt = 1e-3;                   ///< [s], >= 0; 0 applies the commands and moves nothing
    std::span<Command> commands = {};   ///< applied first; their contents are moved out
    std::uint32_t flags = 0;            ///< StepFlag bits that the report starts with
    const StepBudget* budget = nullptr; ///< null: the step takes as long as it needs
};

/// The whole state of an engine between two steps. It lives in memory and never changes.
class EngineState {
public:
    EngineState() = default;
    virtual ~EngineState() = default;
    EngineState(const EngineState&) = delete;
    EngineState& operator=(const EngineState&) = delete;
};

/// The seam behind which an engine works: the native one, or another. Only info(), build() and check() may be called
/// from any thread.
class PhysicsEngine {
public:
    virtual ~PhysicsEngine() = default;
    [[nodiscard]] virtual EngineInfo info() const = 0;
    /// Checks a Def and builds its body; throws an Error. Reads nothing that a step changes.
    [[nodiscard]] virtual std::unique_ptr<BuiltBody> build(const BodyDef& def) const = 0;
    /// Throws an Error if the engine cannot carry out a command that is valid in itself. `def`: that of the body which
    /// the command is for; null if it is for none. Reads nothing that a step changes.
    virtual void check(const Command& /*command*/, const BodyDef* /*def*/) const {}
    /// Computes one step. Never throws: problems are in the report.
    virtual StepReport step(const StepInput& in) = 0;
    /// Writes the whole state into a Frame, reusing its memory.
    virtual void capture(frame::Frame& out) const = 0;
    /// Writes what the log keeps in addition to the report.
    virtual void record(StepRecord& out) const = 0;
    /// The mechanical energy of a body as it is now. Throws an Error if there is no such body, or if the engine cannot
    /// tell.
    [[nodiscard]] virtual MechanicalEnergy energyOf(BodyId /*body*/) const
    {
        fail("mechanicalEnergy is not available with the engine '", info().name, "'");
    }
    /// A hash of the state: the same input gives the same hash at every step. For a soft body it covers positions,
    /// velocities and every edit of its mesh; any other state of a solver affects these a step later, or never.
    [[nodiscard]] virtual std::uint64_t hash() const = 0;
    /// Copies the state: bodies, cut meshes, contacts, and all that the next step starts from.
    [[nodiscard]] virtual std::shared_ptr<const EngineState> save() const = 0;
    /// Returns to a state of this engine, or of another one with the same period: the steps that follow have the bits
    /// of those that followed save(). Throws an Error if it cannot; nothing has changed then.
    virtual void restore(const EngineState& state) = 0;
};

} // namespace filasofia::physics
