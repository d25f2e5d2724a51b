#pragma once

#include "filasofia/core/background.h"
#include "filasofia/engine/body/soft_model.h"
#include "filasofia/engine/soft/mesh_edit.h"
#include "filasofia/linalg/two_level_preconditioner.h"

namespace filasofia::engine {

/// Which numbers a body's preconditioner is made for.
struct PreconditionerPlan {
    std::span<const int> nodes; ///< the unknowns, in their order
    double scale = 1.0;         ///< of the matrix
    double period = 0.0;        ///< [s] of the step
    int blocks = 0;             ///< of unknowns
};

/// Which coarse nodes a body gets.
struct CoarseChoice {
    int target = 0; ///< of the lattice
    int most = 0;   ///< in all, up to which light nodes get coarse nodes of their own
};

/// How many coarse nodes pay: the product with the inverse of their matrix, which grows with the square of their
/// number, should cost less than the elements do. Measured on meshes of 3000 to 30000 elements; half or twice as many
/// cost up to a tenth more.
CoarseChoice coarseChoice(std::size_t freeNodes);
/// The same after a cut. It leaves flaps, which bend over lengths that the lattice of a whole body is too wide for: so
/// twice as many, while that takes little to make. And the tips of thin flaps hang on a few elements, where the error
/// stays longest: so nodes with less than a fifth of the median mass get coarse nodes of their own, the lightest first.
/// Measured on 20 pinned blocks with up to three cuts, iterations until the residual of a random vector is down to
/// 1e-4: 27 to 52 without either, 24 to 53 with the first alone, 25 to 39 with both (24 before the cuts).
CoarseChoice remadeCoarseChoice(std::size_t freeNodes);

/// The preconditioner of a body of elements or springs as it is at rest.
linalg::TwoLevelPreconditioner preconditionerAtRest(const SoftModel& model, const PreconditionerPlan& plan,
                                                    const CoarseChoice& choice);

/// The same for a body whose tissue was parted, made beside its steps. The coarse lattice goes through the mesh as it
/// is now: parts that no longer hang together near by share no coarse nodes.
///
/// It is taken over in a step that is known beforehand, whoever made it and however long that took: the same motion
/// every time, for any number of threads. Who needs it then waits for it, or makes it. There is time for about 2.5
/// times what it takes, so that a body that is cut all the time takes 40 % of a core beside its steps at most.
class CoarseRemake {
public:
    CoarseRemake(const SoftModel& model, const PreconditionerPlan& plan, BackgroundThread& meanwhile);
    ~CoarseRemake();
    CoarseRemake(const CoarseRemake&) = delete;
    CoarseRemake& operator=(const CoarseRemake&) = delete;

    /// Once a step: true in the one in which it is taken over.
    bool isDue() { return --stepsLeft_ <= 0; }
    linalg::CoarseLevel&& take();

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
