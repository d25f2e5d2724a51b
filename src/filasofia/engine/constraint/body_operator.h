#pragma once

#include "filasofia/math/mat3.h"

#include <optional>
#include <span>
#include <vector>

namespace filasofia::engine {

/// Where a constraint acts on a body: a node of a soft body; an element of a rigid body, with the lever arm from its
/// centre of mass [m, world axes]; a link of an articulation, with the arm from the link's origin; a joint of an
/// articulation; or, about an axis, an edge of a rod, an element or a link.
struct ContactPoint {
    int node = 0; ///< soft bodies; 0 for all others, whose unknowns are all moved by one point
    Vec3 arm = {};
    int link = 0;
    std::optional<int> joint = {}; ///< if set, the constraint acts on this joint; `link` and `arm` are unused then
    /// [m] if set, the constraint acts on the angular velocity of a rigid body or a link about this axis, a unit vector
    /// times a length. The velocity is along x, times the length
    std::optional<Vec3> axis = {};
    /// [m] if set, the constraint acts on the spin of the rod's edge `node`: the velocity per spin
    std::optional<Vec3> perSpin = {};
};

/// The vectors of conjugate gradients over one body: p the direction, r the residual, q = A p, w = D^-1 r, z the
/// preconditioned residual, s the residual that the coarse level is applied to.
enum class SolveVector { Direction, Residual, Product, Smoothed, Preconditioned, CoarseResidual };

/// The columns of J at a contact point, world axes, for one block of three unknowns of its body.
struct BlockColumns {
    int block = 0;
    Mat3 j;
};

/// The place of a 3x3 block of D.
struct BlockPlace {
    int row = 0, column = 0;
};

/// D, an approximation of a body's matrix A that consists of few blocks: those of the nodes of a soft body, or all of a
/// rigid body, an articulation or a rod. It is read as 3x3 blocks of unknowns: a node's velocity, a rigid body's
/// velocity and its angular velocity, three joints, or the spins of three edges.
class BodySmoother {
public:
    virtual ~BodySmoother() = default;
    /// D^-1 as seen from a contact point [1/kg], world axes.
    [[nodiscard]] virtual Mat3 compliance(int point) const = 0;
    /// The same for what an impulse at the second point moves at the first one; zero if D does not couple them.
    [[nodiscard]] virtual Mat3 between(int one, int two) const { return one == two ? compliance(one) : Mat3{}; }
    /// Appends the columns of J at a contact point, for the blocks that it moves.
    virtual void addColumns(int point, std::vector<BlockColumns>& out) const = 0;
    [[nodiscard]] virtual Mat3 block(int row, int column) const = 0; ///< a block of D
    /// Appends the places besides the diagonal where D may have blocks, each once, row > column. So every block that a
    /// point moves comes with all that D couples with it.
    virtual void addPlaces(std::vector<BlockPlace>&) const {}
    [[nodiscard]] virtual bool isExact() const { return false; } ///< D is A, and there is no coarse level B
    /// D^-1 couples contact points with different nodes: only the filter of all constraints together knows that.
    [[nodiscard]] virtual bool couplesNodes() const { return false; }
};

/// One body's part of a solve that couples several bodies. Whatever the body's integrator and solver are, it has a
/// symmetric positive definite matrix A over the change x of its velocities, and the vectors of conjugate gradients.
/// Dot products are in joules and impulses at the contact points in newton seconds, whatever scaling the body uses
/// internally.
class BodyOperator {
public:
    virtual ~BodyOperator() = default;

    /// Sets x = 0, r = the right-hand side and p = a first guess. Constraints act at these points until the next call.
    /// Returns the mass of the moving part [kg].
    virtual double begin(std::span<const ContactPoint> points) = 0;
    /// Reads Direction, Smoothed or Preconditioned at the contact points.
    virtual void read(SolveVector from, std::span<Vec3> out) const = 0;
    /// Adds impulses at the contact points to Residual, or to CoarseResidual, which leaves the residual unchanged.
    virtual void add(std::span<const Vec3> impulses, SolveVector to) = 0;

    virtual double multiply() = 0; ///< q = A p; returns the curvature p . q
    /// p . r (Direction, Residual) or z . q (Preconditioned, Product)
    virtual double dot(SolveVector a, SolveVector b) = 0;
    virtual void step(double alpha) = 0;           ///< x += alpha p, r -= alpha q
    virtual void updateDirection(double beta) = 0; ///< p = z + beta p
};

/// Columns F of impulses at a body's contact points, which deflate its coarse level B (CoarseCorrection).
class DeflationOperator {
public:
    virtual ~DeflationOperator() = default;
    /// Appends how the coarse nodes that a contact point follows move it: columns of J P, world axes, of blocks that
    /// are coarse nodes.
    virtual void addCoarseColumns(int point, std::vector<BlockColumns>& out) const = 0;
    virtual void clear() = 0;
    virtual void addColumn(std::span<const Vec3> impulses) = 0;   ///< [N s] at the contact points
    virtual void finish() = 0;                                    ///< computes B F from all columns
    virtual void products(int column, std::span<double> out) = 0; ///< [J] one row of F^T B F, an entry per column
    /// [J] F^T B s, an entry per column. To be called between smooth() and applyCoarse().
    virtual void project(std::span<double> out) = 0;

    // For TiedCoarse, on some of the coarse nodes, three numbers per node:
    /// [m/s] B F of a finished column.
    virtual void readColumn(int column, std::span<const int> coarseNodes, std::span<float> out) const = 0;
    /// [m/s] B s. To be called between smooth() and applyCoarse().
    virtual void readAnswer(std::span<const int> coarseNodes, std::span<float> out) = 0;
    /// s -= these impulses [N s], after project().
    virtual void subtract(std::span<const int> coarseNodes, std::span<const float> impulses) = 0;
};

/// The approximate inverse D^-1 + B of a body's matrix: D is its BodySmoother's; B is any other approximation (the
/// coarse level), or zero.
class BodyPreconditioner {
public:
    virtual ~BodyPreconditioner() = default;
    virtual void smooth() = 0; ///< w = D^-1 r, s = r
    /// z = w + B (s - F shares), with the coefficients `shares` of the deflation columns, if there are any. Returns r .
    /// z.
    virtual double applyCoarse(std::span<const double> shares) = 0;
    virtual void subtractSmoothed(std::span<const Vec3> impulses) = 0; ///< z -= D^-1 impulses
    /// Makes a B that serves where nodes have turned against each other (TwoLevelPreconditioner::blendRotations).
    /// Returns whether B has changed.
    virtual bool blendRotations() { return false; }
    [[nodiscard]] virtual DeflationOperator* deflation() { return nullptr; } ///< null if B cannot be deflated
};

/// A body of a coupled solve.
struct CoupledBody {
    BodyOperator* matrix = nullptr;
    BodySmoother* smoother = nullptr;
    BodyPreconditioner* preconditioner = nullptr;

    [[nodiscard]] DeflationOperator* deflation() const { return preconditioner->deflation(); }
};
template <class Body> CoupledBody coupled(Body& body) { return {&body, &body, &body}; }

} // namespace filasofia::engine
