#pragma once

#include "filasofia/core/background.h"
#include "filasofia/engine/body/soft_model.h"
#include "filasofia/engine/soft/mesh_edit.h"
#include "filasofia/linalg/two_level_preconditioner.h"

namespace filasofia::engine {

/// The unknowns, the scale and the step for which a body's preconditioner is built.
struct PreconditionerPlan {
    std::span<const int> nodes; ///< the unknowns, in their order
    double scale = 1.0;         ///< [1/kg] factor on the matrix
    double period = 0.0;        ///< [s] the step
    int blocks = 0;             ///< blocks of sixteen slots in vectors of unknowns
    bool clustered = false;     ///< for a rebuild: the body has clusters of nodes (ClusterSmoother)
};

/// How many coarse nodes a body gets.
struct CoarseChoice {
    int target = 0; ///< number of nodes of the coarse lattice that is aimed at
    int most = 0;   ///< total number up to which light nodes get coarse nodes of their own
};

/// The number of coarse nodes that pays off: the product with the inverse of their matrix, whose cost grows with the
/// square of their number, should cost less than the elements. Measured on meshes of 3000 to 30000 elements; half or
/// twice as many coarse nodes cost up to a tenth more.
CoarseChoice coarseChoice(std::size_t freeNodes);
/// The same after a cut. A cut leaves flaps, which bend over shorter lengths than the lattice of a whole body resolves:
/// so the number is doubled if that is cheap to build. The tips of thin flaps hang on a few elements, where the error
/// decays most slowly: so nodes with less than a fifth of the median mass get coarse nodes of their own, the lightest
/// first. Measured on 20 pinned blocks with up to three cuts, iterations until the residual of a random vector is down
/// to 1e-4: 27 to 52 without either, 24 to 53 with the first alone, 25 to 39 with both (24 before the cuts).
CoarseChoice coarseChoiceAfterCut(std::size_t freeNodes);

/// Builds the preconditioner of a body at rest.
linalg::TwoLevelPreconditioner preconditionerAtRest(const SoftModel& model, const PreconditionerPlan& plan,
                                                    const CoarseChoice& choice);

/// Rebuilds the coarse level, and the clusters, of a body whose tissue was parted, in the background of its steps. The
/// coarse lattice follows the present mesh: parts that are no longer connected nearby share no coarse nodes.
///
/// The result is taken over in a step that is fixed when the rebuild starts, whichever thread builds it and however
/// long that takes: the motion is the same every time and for any number of threads. If the result is not ready by
/// then, the step waits for it or builds it. The time allowed is about 2.5 times the build time, so that a body that is
/// cut all the time takes at most 40 % of a core beside its steps.
class CoarseRebuild {
public:
    CoarseRebuild(const SoftModel& model, const PreconditionerPlan& plan, BackgroundThread& meanwhile);
    ~CoarseRebuild();
    /// Waits until the result is there; both have it, and take it over in the same step.
    CoarseRebuild(const CoarseRebuild& other);
    CoarseRebuild& operator=(const CoarseRebuild&) = delete;

    /// Called once per step: true in the step in which the result is taken over.
    bool isDue() { return --stepsLeft_ <= 0; }
    linalg::CoarseLevel&& take();
    linalg::ClusterSmoother&& takeClusters(); ///< after take()

    /// Records nodes that edits have added since the rebuild started.
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
