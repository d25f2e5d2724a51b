#pragma once

#include "filasofia/engine/soft/assembled_system.h"
#include "filasofia/engine/soft/matrix_free_operator.h"

namespace filasofia::engine {

/// What pulls at the nodes that pins hold hard, and how many groups of pins hold each node: reactions are found there.
struct HeldParts {
    std::vector<int> elements, springs;
    std::vector<int> holders; ///< per node; empty where none is held
};

/// One soft body's equations of one step, and the memory they are made in. What of it outlives a step follows from the
/// model, but for the two flags and for what a cut body's preconditioner still has of the mesh before: that follows
/// from its edits. One of the two kinds is there.
struct SoftSystem {
    std::unique_ptr<MatrixFreeSystem> matrixFree; ///< in float, what a body has unless it asks for something else
    std::unique_ptr<MatrixFreeOperator> coupled;  ///< over matrixFree, once it had to be solved with other bodies
    std::unique_ptr<AssembledSystem> assembled;   ///< in double, the reference

    HeldParts held;
    bool tuned = false;    ///< the model was in a tune's hands: it need not be what its Def says
    bool outdated = false; ///< it is not the model's any more: made anew before the next solve

    std::vector<Vec3> forces;             ///< [N] gravity, given, pressure, pins
    std::vector<Vec3> x, v, dv, leftover; ///< the new state, until it is known to be finite
};

/// Has the system rebuilt after the last command of the step, which may change more. `tuned`: its model is no longer
/// what its Def says.
inline void outdate(bool tuned, SoftSystem& system)
{
    system.outdated = true;
    system.tuned = tuned;
}

/// Brings what pulls at held nodes in line with an edit.
void followHeld(const SoftModel& model, const MeshEdit& edit, HeldParts& parts);

/// `period` [s]: the step that the solver prepares for.
SoftSystem makeSystem(const SoftModel& model, double period);

} // namespace filasofia::engine
