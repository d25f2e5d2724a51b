#pragma once

#include "filasofia/engine/body/soft_model.h"
#include "filasofia/engine/elastic/corotational.h"
#include "filasofia/engine/elastic/element_blocks.h"
#include "filasofia/engine/integration/euler.h"
#include "filasofia/engine/soft/mesh_edit.h"
#include "filasofia/engine/soft/rigid_motion.h"
#include "filasofia/linalg/matrix_free_cg.h"

#include <cstdint>
#include <memory>

namespace filasofia {
class BackgroundThread;
}

namespace filasofia::engine {

class CoarseRemake;
struct PreconditionerPlan;

/// A number as the solver has it.
constexpr float asFloat(double value) { return static_cast<float>(value); }

/// The equations of one step as they are solved by default: in float, element by element, without a matrix.
///
/// Everything is divided by the mean nodal mass, so that the numbers are of the size of velocities whatever the body is
/// made of; positions are taken relative to one of the body's nodes. Nodes lie in an order of their own: those that
/// move first, along a space-filling curve, then those that are held, whose entries in every vector stay zero.
class MatrixFreeSystem final : public linalg::NodeOperator {
public:
    /// `period` [s]: the step that the preconditioner is made for.
    MatrixFreeSystem(const SoftModel& model, double period);
    ~MatrixFreeSystem() override;

    /// True where float holds all numbers of the model; extreme ones need the assembled system.
    static bool fits(const SoftModel& model, double period);

    /// Rotations, forces and right-hand side at a state. `given` [N]: what acts without any deformation. `inertia`
    /// multiplies the masses in the matrix.
    void assemble(const SoftModel& model, std::span<const Vec3> given, double dt, double inertia, SoftState& state,
                  WorkerPool& pool);

    /// The change of the velocities, `dv` holding the first guess, and the impulse [N s] that the solve left undone.
    linalg::NodeSolveReport solve(const linalg::SolveLimits& limits, std::span<Vec3> dv, std::span<Vec3> leftover,
                                  WorkerPool& pool);
    /// What follows when dv and the residual were found elsewhere, together with other bodies'. What that solve lacks
    /// is not done here as far as the body as a whole could: what it touches would have its say.
    void finish(const linalg::NodeSolveReport& report, std::span<Vec3> dv, std::span<Vec3> leftover, WorkerPool& pool);
    /// Per block of sixteen elements, bits for those that may have a principal stress of `limit` [Pa] or more, with the
    /// rotations of the step's start; false where none has.
    bool findStressed(const SoftState& state, double limit, WorkerPool& pool, std::vector<std::uint16_t>& stressed);
    /// [m/s] What the last solve itself found for a node, before finish() made up for what the body as a whole lacks;
    /// zero where it is held.
    [[nodiscard]] Vec3 solved(int node) const;
    /// [N s] that the last solve left undone of a node; zero where it is held.
    [[nodiscard]] Vec3 undone(int node) const;
    /// The same where the masses are all there is in the matrix.
    void solveExplicit(std::span<Vec3> dv) const;

    /// Follows an edit of the mesh that the model has already. True where vectors of
    /// unknowns have another size from now on.
    bool edit(const SoftModel& model, const MeshEdit& edit);
    /// Once in every step, after the edits: where one parted tissue, the coarse level is made anew meanwhile, from the
    /// body as it is now, and taken over some steps later.
    void followParting(const SoftModel& model, BackgroundThread& meanwhile);

    double multiply(const linalg::NodeArray& p, linalg::NodeArray& q, WorkerPool& pool) override;

    /// z = M^-1 r, M close to the matrix; returns r . z
    double precondition(const linalg::NodeArray& r, linalg::NodeArray& z, WorkerPool& pool);
    /// A vector of unknowns, zero.
    [[nodiscard]] linalg::NodeArray unknowns() const { return linalg::NodeArray(dv_.blocks(), dv_.pinnedBlocks()); }

    [[nodiscard]] int coarseNodes() const { return preconditioner_.coarseNodes(); }

private:
    friend class MatrixFreeOperator;
    static constexpr std::size_t kRotationsPerNode = 4; ///< elements that say how a node turns
    void orderNodes(const SoftModel& model);
    void makeVectors(int heldBlocks);
    /// Element `element` of the model, or without stiffness, to keep a lane busy.
    void writeElement(const FemElement& e, int element, bool real);
    void makeElements(const SoftModel& model);
    void makeSprings(const SoftModel& model);
    void makeGather(const SoftModel& model);
    [[nodiscard]] PreconditionerPlan plan() const;

    bool reserve(const SoftModel& model, const MeshEdit& edit);
    void addNode(const SoftModel& model, int node, const MeshEdit::Node& made);
    void interpolate(int slot, const MeshEdit::Node& made);
    void moveElement(const SoftModel& model, int element);
    void refreshNode(const SoftModel& model, int slot);

    void load(std::span<const Vec3> from, Vec3 origin, linalg::NodeArray& to, WorkerPool& pool) const;

    void loadImpulses(std::span<const Vec3> forces, std::span<const Vec3> leftover, double dt, WorkerPool& pool);

    /// The part of its motion w = v + dv that a step must give up so as not to make energy; usually none. An impulse r
    /// that the solve left undone acts on the body as a push by -r would. With what was handed on from the last step,
    /// l, a step changes the energy by
    ///     E' - E = - dv . M dv / 2 - h a w . M w - (h^2 / 2 + h b) w . K w - (r - l) . w
    /// (exactly so where forces are linear). Where that is not negative the body is slowed down, all of it alike, until
    /// the push does no work: less a part t, the residual of w is r + t A w. A body that nothing holds is slowed down
    /// only in what it does besides moving as a rigid body: w is measured from that.
    double heldBack(WorkerPool& pool);

    void finish(const linalg::NodeSolveReport& report, const RigidMotion& push, std::span<Vec3> dv,
                std::span<Vec3> leftover, WorkerPool& pool);

    /// The rigid motion that has the momentum and the angular momentum of the masses times v + dv; none where something
    /// holds the body.
    [[nodiscard]] RigidMotion rigidMotion() const;
    /// The one that the change of velocities lacks of what pushes the body from outside. Elasticity does not resist it,
    /// and so neither tolerance nor rounding may decide about it: a stiff body that spins freely would gain spin.
    [[nodiscard]] RigidMotion rigidPush() const;
    template <class MomentumOf> [[nodiscard]] RigidMotion rigidMotionOf(const MomentumOf& momentumOf) const;

    bool free_ = false;           ///< nothing holds the body
    double scale_ = 1.0;          ///< [1/kg]
    double period_ = 0.0;         ///< [s] the preconditioner's
    bool preconditioned_ = false; ///< there is one
    int freeNodes_ = 0;           ///< they are in slots [0, freeNodes_)
    int heldNodes_ = 0;
    int elementCount_ = 0;
    Lame stiffest_;               ///< of all elements that there ever were
    int freeBlocks_ = 0;          ///< blocks of sixteen slots that vectors of unknowns have; edits need room
    std::vector<int> nodeOf_;     ///< per slot: the model's node, or -1
    std::vector<int> slotOf_;     ///< per node of the model
    std::vector<float> masses_;   ///< per free slot, scaled
    std::vector<float> pins_;     ///< per free slot: stiffness of its pin springs, scaled
    std::vector<float> diagonal_; ///< per free slot: what the step's matrix has of pins

    std::vector<ElementBlock> elements_;
    std::vector<WarpedBlock> warped_;
    std::vector<SpringBlock> springs_;
    std::vector<SpringMatrixBlock> springMatrices_;
    linalg::Gather gather_;                      ///< the corners around each free slot
    linalg::Gather turns_;                       ///< some of the element corners, for the node rotations
    std::vector<linalg::NodeBlock> corners_;     ///< what elements and springs say to their nodes, sixteen to a block
    std::vector<linalg::NodeBlock> quaternions_; ///< of the elements

    double massWeight_ = 1.0;  ///< of the masses in the step's matrix
    double massLoss_ = 0.0;    ///< [-] damping of the masses in the step's right-hand side
    double elasticLoss_ = 0.5; ///< (h^2 / 2 + h b) / (h^2 + h b)
    linalg::NodeArray outer_;  ///< of a free body: the impulse from outside, scaled
    linalg::NodeArray x_, v_, residual_, handedOn_, dv_, scratch_, product_, zeros_;
    double size_ = 0.0; ///< square of the right-hand side
    std::vector<double> sums_;
    linalg::TwoLevelPreconditioner preconditioner_;
    bool parted_ = false;                  ///< since the coarse level, or the one being made, knew the mesh
    std::unique_ptr<CoarseRemake> remake_; ///< of the coarse level being made
    linalg::MatrixFreeCg cg_;
};

} // namespace filasofia::engine
