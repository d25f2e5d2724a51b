#pragma once

#include "filasofia/core/background.h"
#include "filasofia/engine/mesh_edit.h"
#include "filasofia/engine/model.h"
#include "filasofia/linalg/two_level_preconditioner.h"

namespace filasofia::engine {

/// Which numbers a body's preconditioner is made for.
struct PreconditionerPlan {
    std::span<const int> nodes; ///< the unknowns, in their order
    double scale = 1.0;         ///< of the matrix
    double period = 0.0;        ///< [s] of the step
    int blocks = 0;             ///< of unknowns
};

/// How many coarse nodes pay: the product with the inverse of their matrix, which grows with the square of their
/// number, should cost less than the elements do. Measured on meshes of 3000 to 30000 elements; half or twice as many
/// cost up to a tenth more.
int coarseTarget(std::size_t freeNodes);
/// The same after a cut, whose flaps bend over lengths that the lattice of a whole body is too wide for: twice as many,
/// while that takes little to make. Measured on a block cut through: 1.07 times the iterations before the cut instead
/// of 1.27, and 1.70 with the coarse level left as it was.
int remadeCoarseTarget(std::size_t freeNodes);

/// The preconditioner of a body of elements or springs as it is at rest, with about `target` coarse nodes.
linalg::TwoLevelPreconditioner preconditionerAtRest(const SoftModel& model, const PreconditionerPlan& plan, int target);

/// The same for a body whose tissue was parted, made beside its steps. The coarse lattice goes through the mesh as it
/// is now: parts that no longer hang together near by share no coarse nodes.
///
/// It is taken over in a step that is known beforehand, whoever made it and however long that took: the same motion
/// every time, for any number of threads. Who needs it then waits for it, or makes it; there is time for about four
/// times what it takes, so that a body that is cut all the time takes no more than a quarter of a core beside its
/// steps.
class CoarseRemake {
public:
    CoarseRemake(const SoftModel& model, const PreconditionerPlan& plan, BackgroundThread& meanwhile);
    ~CoarseRemake();
    CoarseRemake(const CoarseRemake&) = delete;
    CoarseRemake& operator=(const CoarseRemake&) = delete;

    /// Once a step: true in the one in which it is taken over.
    bool isDue() { return --stepsLeft_ <= 0; }
    linalg::TwoLevelPreconditioner&& take();

    /// Nodes that came since it was begun.
    void add(std::span<const MeshEdit::Node> nodes) { since_.insert(since_.end(), nodes.begin(), nodes.end()); }
    [[nodiscard]] const std::vector<MeshEdit::Node>& since() const { return since_; }

private:
    struct Work;
    std::shared_ptr<Work> work_;
    std::shared_ptr<BackgroundJob> job_;
    int stepsLeft_;
    std::vector<MeshEdit::Node> since_;
};

} // namespace filasofia::engine
