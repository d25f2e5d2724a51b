#pragma once

#include "filasofia/core/copied_ptr.h"
#include "filasofia/engine/soft/assembled_system.h"
#include "filasofia/engine/soft/matrix_free_operator.h"
#include "filasofia/engine/soft/pinned_parts.h"
#include "filasofia/engine/soft/rod_system.h"

namespace filasofia::engine {

/// The equations of one soft body's step, and their memory. What persists from step to step is a function of the model,
/// except for the two flags and for the preconditioner of a body that was cut, which also depends on the history of its
/// edits. Either `matrixFree`, `assembled` or `rod` is set.
struct SoftSystem {
    CopiedPtr<MatrixFreeSystem> matrixFree; ///< in float, the default
    /// Operator of matrixFree; set once the body is part of a coupled solve.
    std::unique_ptr<MatrixFreeOperator> coupled;
    std::vector<RankOneStiffness> cavities;     ///< what cavities add to the matrix of the present step
    std::unique_ptr<AssembledSystem> assembled; ///< in double, the reference solver
    CopiedPtr<RodSystem> rod;                   ///< in double, for a rod

    SoftSystem() = default;
    /// The copy makes an assembled system again before its next solve: it is a function of the model.
    SoftSystem(const SoftSystem& other);
    SoftSystem(SoftSystem&&) noexcept = default;
    SoftSystem& operator=(const SoftSystem& other);
    SoftSystem& operator=(SoftSystem&&) noexcept = default;
    ~SoftSystem() = default;

    PinnedParts held;
    bool tuned = false;    ///< the model may differ from what its Def and its material say
    bool outdated = false; ///< the model has changed: the system is rebuilt before the next solve

    std::vector<Vec3> forces;             ///< [N] gravity, nodal forces, pressure, pin springs
    std::vector<Vec3> x, v, dv, residual; ///< the new state, until it is known to be usable
    std::vector<Vec3> onPins;             ///< [N] scratch: all forces on hard-pinned nodes
};

/// Marks the system as outdated: it is rebuilt after the last command of the step, as later commands may change more.
/// `tuned`: the model may differ from what its Def and its material say.
inline void outdate(bool tuned, SoftSystem& system)
{
    system.outdated = true;
    system.tuned = tuned;
}

/// Updates the system after a change of the tissue of these elements, ascending; the model is up to date already.
void followTissue(const SoftModel& model, const std::vector<int>& elements, SoftSystem& system);

/// Logs a warning if a body that collides is too stiff for its step: stresses hide from a solver how a very stiff body
/// moves as a whole, and what pushes it.
void warnOfStiffness(const SoftModel& model, double period);

/// Builds the system of a body, assembled if float cannot represent the model. `period` [s]: the step that the solver
/// prepares for.
SoftSystem makeSystem(const SoftModel& model, double period);

} // namespace filasofia::engine
