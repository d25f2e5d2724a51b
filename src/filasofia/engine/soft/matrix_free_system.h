#pragma once

#include "filasofia/core/copied_ptr.h"
#include "filasofia/engine/body/soft_model.h"
#include "filasofia/engine/elastic/element_blocks.h"
#include "filasofia/engine/elastic/spring_blocks.h"
#include "filasofia/engine/integration/euler.h"
#include "filasofia/engine/soft/cavity_system.h"
#include "filasofia/engine/soft/mesh_edit.h"
#include "filasofia/engine/soft/nodal_volumes.h"
#include "filasofia/engine/soft/pinned_parts.h"
#include "filasofia/engine/soft/rigid_motion.h"
#include "filasofia/engine/soft/shell_system.h"
#include "filasofia/linalg/matrix_free_cg.h"

#include <cstdint>
#include <memory>
#include <tuple>
#include <utility>

namespace filasofia {
class BackgroundThread;
}

namespace filasofia::engine {

class CoarseRebuild;
struct PreconditionerPlan;

inline std::span<float> floats(std::vector<linalg::NodeBlock>& blocks)
{
    if (blocks.empty()) return {};
    return {blocks.data()->values[0], 4 * kBlock * blocks.size()};
}

/// The equations of one step in the form that the default solver uses: in float, element by element, without a matrix.
///
/// Everything is divided by the mean nodal mass, so that the numbers are of the order of velocities whatever the body
/// is made of; positions are relative to one of the body's nodes. Nodes are stored in slots in another order than in
/// the model: first the free nodes, along a space-filling curve, then the pinned ones, whose entries in every vector
/// stay zero.
class MatrixFreeSystem final : public linalg::NodeOperator {
public:
    /// `period` [s]: the step that the preconditioner is built for.
    MatrixFreeSystem(const SoftModel& model, double period);
    /// Waits for a rebuild of the coarse level that is in progress, whose result both have.
    MatrixFreeSystem(const MatrixFreeSystem& other);
    MatrixFreeSystem& operator=(const MatrixFreeSystem&) = delete;
    ~MatrixFreeSystem() override;

    /// True if float can represent all numbers of the model; extreme models need the assembled system.
    static bool fits(const SoftModel& model, double period);

    /// Computes rotations, forces and right-hand side at a state. `given` [N]: the forces other than elasticity and
    /// damping. `inertia` [-] multiplies the masses in the matrix.
    void assemble(const SoftModel& model, std::span<const Vec3> given, double dt, double inertia, SoftState& state,
                  WorkerPool& pool);

    /// Solves for the change of the velocities. `dv` [m/s]: the first guess, then the result. `residual` [N s]: the
    /// part of the residual impulse that the next step takes over. `iterations`: those of the last step's solve.
    linalg::NodeSolveReport solve(const linalg::SolveLimits& limits, int iterations, std::span<Vec3> dv,
                                  std::span<Vec3> residual, WorkerPool& pool);
    /// Writes dv and `residual` after a coupled solve, which has left its result in this system. The error of the rigid
    /// motion is not corrected here as in solve(): it depends on the bodies in contact.
    void finish(const linalg::NodeSolveReport& report, std::span<Vec3> dv, std::span<Vec3> residual, WorkerPool& pool);
    /// Per block of sixteen elements: bits of the elements that may have a principal stress of `limit` [Pa] or more,
    /// with the rotations of the step's start. Empty if any element may. Returns false if there is no such element.
    bool findStressed(const SoftModel& model, const SoftState& state, double limit, WorkerPool& pool,
                      std::vector<std::uint16_t>& stressed);
    /// Per block of sixteen elements: bits of the elements that were inside out at the state of the last assemble().
    [[nodiscard]] std::span<const std::uint16_t> inverted() const { return inverted_; }
    /// [-] One per element, if FemMaterial::validStrain is finite: by how much a principal stretch differed from 1, or
    /// a bound of that which is at most validStrain.
    [[nodiscard]] std::span<const float> strains() const { return strains_; }
    /// [N s] Takes a free node's part of the right-hand side out of the step that was assembled, external impulses
    /// included: it is solved elsewhere.
    Vec3 takeImpulse(int node);
    /// Keeps the right-hand side, which a solve uses up; the next solves may begin with it again.
    void keepImpulses() { kept_ = {residual_, handedOn_}; }
    void restoreImpulses() { std::tie(residual_, handedOn_) = kept_; }
    /// To be called after assemble(): keeps what elements, springs and triangles push on hard-pinned nodes.
    void keepHeld(const SoftModel& model, const PinnedParts& held);
    /// Adds to `forces` [N], per node of the model, what elements, springs and triangles did in the step of dt [s] to
    /// the hard-pinned nodes: f - (h + b) K (v + dv), as the step's equation has it. `dv` [m/s]: its solution.
    void addHeldForces(double dt, const SoftModel& model, const PinnedParts& held, std::span<const Vec3> dv,
                       WorkerPool& pool, std::span<Vec3> forces);
    /// The change of the velocities in an explicit step, in which the matrix is that of the masses.
    void solveExplicit(std::span<Vec3> dv) const;

    /// Updates the system after an edit of the mesh; the model is up to date already. Returns true if vectors of
    /// unknowns have another size from now on.
    bool edit(const SoftModel& model, const MeshEdit& edit);
    /// Updates the system after a change of the tissue of these elements, ascending. Returns false, and changes
    /// nothing, if float cannot represent the model any more.
    bool editTissue(const SoftModel& model, const std::vector<int>& elements);
    /// Called once per step, after the edits. If an edit has parted tissue, the coarse level is rebuilt in the
    /// background from the present mesh, and taken over some steps later.
    void followParting(const SoftModel& model, BackgroundThread& meanwhile);

    /// What the cavities add to the matrix, from the next assemble() on.
    void setCavities(std::span<const RankOneStiffness> cavities);

    double multiply(const linalg::NodeArray& p, linalg::NodeArray& q, WorkerPool& pool) override;

    /// z = M^-1 r, where M approximates the matrix; returns r . z
    double precondition(const linalg::NodeArray& r, linalg::NodeArray& z, WorkerPool& pool);
    /// A vector of unknowns, zero.
    [[nodiscard]] linalg::NodeArray unknowns() const { return linalg::NodeArray(dv_.blocks(), dv_.pinnedBlocks()); }

    [[nodiscard]] int coarseNodes() const { return preconditioner_.coarseNodes(); }

    // What attachments to other bodies need to know of the preconditioner, at a free node of the model:
    /// The coarse nodes of the lattice that it follows; weight 0 if there is none.
    [[nodiscard]] linalg::Interpolation coarseWeights(int node) const;
    [[nodiscard]] Mat3 rotation(int node) const;     ///< from rest to the state of the last assemble()
    [[nodiscard]] double compliance(int node) const; ///< [1/kg] D^-1, mean of all directions
    /// [1/kg] An entry of A_c^-1; unknowns of the lattice, three per coarse node.
    [[nodiscard]] double coarseCompliance(std::size_t row, std::size_t column) const;
    /// Whether tie() was called since the coarse level was built or replaced.
    [[nodiscard]] bool isTied() const { return tied_; }
    void tie() { tied_ = true; }

private:
    friend class MatrixFreeOperator;
    static constexpr std::size_t kRotationsPerNode = 4; ///< number of elements whose mean rotation is that of a node
    void orderNodes(const SoftModel& model);
    void makeVectors(int heldBlocks);
    /// Writes lane `element` from an element; without stiffness if not `real`, to fill up the last block.
    void writeElement(const FemElement& e, int element, bool real);
    /// The same for the fibres of `source`, an element of the model.
    void writeFibres(const SoftModel& model, int source, int element, bool real);
    void makeElements(const SoftModel& model);
    void makeSprings(const SoftModel& model);
    void makeShell(const SoftModel& model);
    void makeGather(const SoftModel& model);
    void makeVolumes(const SoftModel& model);
    [[nodiscard]] PreconditionerPlan plan() const;

    bool reserve(const SoftModel& model, const MeshEdit& edit);
    void addNode(const SoftModel& model, int node, const MeshEdit::Node& made);
    void interpolate(int slot, const MeshEdit::Node& made);
    void moveElement(const SoftModel& model, int element);
    /// `grown`: slots have moved.
    void editShell(const SoftModel& model, const MeshEdit& edit, bool grown);
    void refreshNode(const SoftModel& model, int slot);

    void load(std::span<const Vec3> from, Vec3 origin, linalg::NodeArray& to, WorkerPool& pool) const;

    /// Whether the smoother can be made of the present tangents alone, and differs from that at rest.
    [[nodiscard]] bool mayFollowTangents() const;
    /// Makes it so, until the next assemble().
    void smoothByTangents(WorkerPool& pool);
    /// Chooses the preconditioner of a shell: that of rest, or that of its present blocks if it is crumpled.
    void followCreases();

    void loadImpulses(std::span<const Vec3> forces, std::span<const Vec3> residual, double dt, WorkerPool& pool);

    /// corners = K p of at least these parts.
    void multiplyHeld(const PinnedParts& held, const linalg::NodeArray& p, WorkerPool& pool);
    void listHeldCorners(const SoftModel& model, const PinnedParts& held);
    void addHeldCorners(double factor); ///< to heldImpulses_, `factor` times

    /// The fraction of the motion w = v + dv that must be removed so that the step does not gain energy; usually 0. A
    /// residual impulse r of the solve acts on the body like an external impulse -r. With the residual impulse l handed
    /// on from the last step, a step changes the energy by
    ///     E' - E = - dv . M dv / 2 - h a w . M w - (h^2 / 2 + h b) w . K w - (r - l) . w
    /// with Rayleigh's coefficients a and b (exact if forces are linear). If that is not negative, the whole body is
    /// slowed down uniformly until the residual does no work: the residual of (1 - t) w is
    /// r + t A w. If the body is not pinned, its rigid motion is not slowed down: w is then relative to that.
    double heldBack(WorkerPool& pool);

    /// `share` [-] of what the coarse nodes can carry of the residual impulse is written to `residual`.
    void finish(const linalg::NodeSolveReport& report, const RigidMotion& push, double share, std::span<Vec3> dv,
                std::span<Vec3> residual, WorkerPool& pool);

    /// The rigid motion with the momentum and the angular momentum of the velocities v + dv; zero if the body is
    /// pinned.
    [[nodiscard]] RigidMotion rigidMotion() const;
    /// The rigid motion that dv lacks of the response to the external impulses. Elasticity does not resist it, so it
    /// must not depend on tolerance or rounding: a stiff body that spins freely would gain spin.
    [[nodiscard]] RigidMotion rigidPush() const;
    template <class MomentumOf> [[nodiscard]] RigidMotion rigidMotionOf(const MomentumOf& momentumOf) const;

    bool free_ = false;           ///< the body is not pinned
    double scale_ = 1.0;          ///< [1/kg]
    double period_ = 0.0;         ///< [s] the step that the preconditioner is built for
    bool preconditioned_ = false; ///< there is a preconditioner: the integrator is implicit
    int freeNodes_ = 0;           ///< free nodes are in slots [0, freeNodes_)
    int heldNodes_ = 0;
    int elementCount_ = 0;
    Lame stiffest_;               ///< the largest constants of all elements that have ever existed
    int freeBlocks_ = 0;          ///< blocks of sixteen slots in vectors of unknowns, with room for edits
    std::vector<int> nodeOf_;     ///< per slot: the model's node; -1: empty
    std::vector<int> slotOf_;     ///< per node of the model: its slot
    std::vector<float> masses_;   ///< per free slot, scaled
    std::vector<float> pins_;     ///< per free slot: scaled stiffness of its pin springs
    std::vector<float> diagonal_; ///< per free slot: the pin springs' part of the step's matrix

    std::vector<ElementBlock> elements_;
    ElementTangents tangents_;
    std::vector<FibreBlock> fibres_; ///< one list of blocks per family of fibres, one after another
    std::vector<FibreTangentBlock> fibreTangents_;
    NodalVolumes volumes_;
    std::vector<SpringBlock> springs_;
    std::vector<SpringMatrixBlock> springMatrices_;
    ShellSystem shell_;
    CavitySystem cavities_;
    linalg::Gather gather_; ///< the corners of elements, springs and triangles around each free slot
    linalg::Gather turns_;  ///< some of the elements or triangles, for the rotations of nodes
    /// Contributions of elements, springs and triangles to their nodes, in blocks of sixteen.
    std::vector<linalg::NodeBlock> corners_;
    std::vector<linalg::NodeBlock> mixed_;       ///< see smoothByTangents(); empty until it is needed
    std::vector<std::uint16_t> inverted_;        ///< bits of the elements that were inside out in assemble()
    std::vector<float> strains_;                 ///< see strains()
    std::vector<linalg::NodeBlock> quaternions_; ///< rotations of the elements

    double dt_ = 0.0;          ///< [s] given to the last assemble()
    double massWeight_ = 1.0;  ///< [-] factor on the masses in the step's matrix
    double massLoss_ = 0.0;    ///< [-] mass damping in the step's right-hand side, h a
    double elasticLoss_ = 0.5; ///< [-] (h^2 / 2 + h b) / (h^2 + h b)
    linalg::NodeArray outer_;  ///< scaled external impulses; only if the body is not pinned
    linalg::NodeArray x_, v_, residual_, handedOn_, dv_, scratch_, product_, zeros_;
    std::pair<linalg::NodeArray, linalg::NodeArray> kept_; ///< residual_ and handedOn_, see keepImpulses()
    /// A corner of an element, spring or triangle at a pinned node.
    struct HeldCorner {
        int corner = 0; ///< where it begins among the floats of corners_
        int pin = 0;    ///< number of the node among the pinned ones, in the order of slots
    };
    std::vector<HeldCorner> heldCorners_;
    std::vector<linalg::Blocks> heldBlocks_; ///< those of elements that have such a corner, as ranges
    bool heldListed_ = false;                ///< both are those of the present mesh
    std::vector<Vec3> heldImpulses_;         ///< [N s] on each pinned node, in the order of slots: see keepHeld()
    double size_ = 0.0;                      ///< squared norm of the right-hand side
    std::vector<double> sums_;
    linalg::TwoLevelPreconditioner preconditioner_;
    std::vector<Mat3> present_;        ///< scratch: the blocks on the diagonal of a crumpled shell
    bool tied_ = false;                ///< see isTied()
    bool parted_ = false;              ///< tissue has been parted since the coarse level was built or its rebuild began
    CopiedPtr<CoarseRebuild> rebuild_; ///< rebuild of the coarse level in progress; null: none
    linalg::MatrixFreeCg cg_;
};

} // namespace filasofia::engine
