#pragma once

#include "filasofia/math/mat3.h"

#include <optional>
#include <span>

namespace filasofia::engine {

/// Where a constraint acts on a body: a node of a soft one; an element of a rigid one, with the lever arm from its
/// centre of mass [m, world axes]; a link of an articulated one, with the arm from its origin, or one of its joints.
struct ContactPoint {
    int node = 0; ///< soft; 0 for all others, whose unknowns are all moved by one point
    Vec3 arm = {};
    int link = 0;
    std::optional<int> joint = {}; ///< the joint itself; `link` and `arm` are unused then
};

/// The vectors of conjugate gradients over one body: p the direction, r the residual, q = A p, w = D^-1 r, z the
/// preconditioned residual, s the residual that the coarse level is applied to.
enum class SolveVector { Direction, Residual, Product, Smoothed, Preconditioned, CoarseResidual };

/// One body's part of a solve that spans several. Whatever its integrator and its solver are, it has a symmetric
/// positive definite matrix A over the change x of its velocities and the vectors of the conjugate gradients. Sums over
/// a body come in joules and impulses at its contact points in newton seconds, whatever scale it computes in.
class BodyOperator {
public:
    virtual ~BodyOperator() = default;

    /// x = 0, r = the right-hand side, p = a first guess. From now on constraints act at these points. Returns the mass
    /// [kg] of what moves.
    virtual double begin(std::span<const ContactPoint> points) = 0;
    /// D^-1 as seen from a contact point [1/kg], world axes.
    [[nodiscard]] virtual Mat3 compliance(int point) const = 0;
    /// The vector at the contact points: Direction, Smoothed or Preconditioned.
    virtual void read(SolveVector from, std::span<Vec3> out) const = 0;
    /// Adds impulses at the contact points: to Residual, or to CoarseResidual, which leaves the residual alone.
    virtual void add(std::span<const Vec3> impulses, SolveVector to) = 0;

    virtual double multiply() = 0; ///< q = A p; returns the curvature p . q
    /// p . r (Direction, Residual) or z . q (Preconditioned, Product)
    virtual double dot(SolveVector a, SolveVector b) = 0;
    virtual void step(double alpha) = 0;           ///< x += alpha p, r -= alpha q
    virtual void updateDirection(double beta) = 0; ///< p = z + beta p
};

/// Columns F of impulses at a body's contact points, by which its coarse level B can be corrected (PatchCorrection).
class CoarseDeflation {
public:
    virtual ~CoarseDeflation() = default;
    virtual void clear() = 0;
    virtual void addColumn(std::span<const Vec3> impulses) = 0;         ///< [N s] at the contact points
    virtual void finish() = 0;                                          ///< all columns are there: B F
    virtual void products(int column, std::span<double> out) const = 0; ///< [J] per column: F^T B F, one row of it
    virtual void project(std::span<double> out) = 0; ///< [J] per column: F^T B s, between smooth() and applyCoarse()
};

/// The approximate inverse D^-1 + B of a body's matrix: D small blocks on the diagonal (the smoother), B any other (the
/// coarse level), or nothing.
class BodyPreconditioner {
public:
    virtual ~BodyPreconditioner() = default;
    virtual void smooth() = 0; ///< w = D^-1 r, s = r
    /// z = w + B (s - F shares), the shares of the deflation's columns, if any; returns r . z
    virtual double applyCoarse(std::span<const double> shares) = 0;
    virtual void subtractSmoothed(std::span<const Vec3> impulses) = 0;     ///< z -= D^-1 impulses
    [[nodiscard]] virtual CoarseDeflation* deflation() { return nullptr; } ///< null: B cannot be corrected
};

/// A body of a coupled solve.
struct CoupledBody {
    BodyOperator* matrix = nullptr;
    BodyPreconditioner* preconditioner = nullptr;
};
template <class Body> CoupledBody coupled(Body& body) { return {&body, &body}; }

} // namespace filasofia::engine
