#pragma once

#include "filasofia/math/mat3.h"

#include <optional>
#include <span>

namespace filasofia::engine {

/// Where a constraint acts on a body: a node of a soft body; an element of a rigid body, with the lever arm from its
/// centre of mass [m, world axes]; a link of an articulation, with the arm from the link's origin; or a joint of an
/// articulation.
struct ContactPoint {
    int node = 0; ///< soft bodies; 0 for all others, whose unknowns are all moved by one point
    Vec3 arm = {};
    int link = 0;
    std::optional<int> joint = {}; ///< if set, the constraint acts on this joint; `link` and `arm` are unused then
};

/// The vectors of conjugate gradients over one body: p the direction, r the residual, q = A p, w = D^-1 r, z the
/// preconditioned residual, s the residual that the coarse level is applied to.
enum class SolveVector { Direction, Residual, Product, Smoothed, Preconditioned, CoarseResidual };

/// A body with so few unknowns that its matrix can be written out: a rigid element or an articulation.
class SmallBody {
public:
    virtual ~SmallBody() = default;
    [[nodiscard]] virtual std::size_t unknowns() const = 0;
    virtual void writeMatrix(std::span<double> a) const = 0; ///< A, row by row; given as zeros
    /// The columns of J at a contact point, one per unknown, world axes.
    virtual void writeColumns(int point, std::span<Vec3> j) const = 0;
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
    /// D^-1 as seen from a contact point [1/kg], world axes.
    [[nodiscard]] virtual Mat3 compliance(int point) const = 0;
    /// Reads Direction, Smoothed or Preconditioned at the contact points.
    virtual void read(SolveVector from, std::span<Vec3> out) const = 0;
    /// Adds impulses at the contact points to Residual, or to CoarseResidual, which leaves the residual unchanged.
    virtual void add(std::span<const Vec3> impulses, SolveVector to) = 0;

    [[nodiscard]] virtual const SmallBody* small() const { return nullptr; } ///< null if the body is not small

    virtual double multiply() = 0; ///< q = A p; returns the curvature p . q
    /// p . r (Direction, Residual) or z . q (Preconditioned, Product)
    virtual double dot(SolveVector a, SolveVector b) = 0;
    virtual void step(double alpha) = 0;           ///< x += alpha p, r -= alpha q
    virtual void updateDirection(double beta) = 0; ///< p = z + beta p
};

/// Columns F of impulses at a body's contact points, which deflate its coarse level B (PatchCorrection).
class DeflationOperator {
public:
    virtual ~DeflationOperator() = default;
    virtual void clear() = 0;
    virtual void addColumn(std::span<const Vec3> impulses) = 0;         ///< [N s] at the contact points
    virtual void finish() = 0;                                          ///< computes B F from all columns
    virtual void products(int column, std::span<double> out) const = 0; ///< [J] one row of F^T B F, an entry per column
    /// [J] F^T B s, an entry per column. To be called between smooth() and applyCoarse().
    virtual void project(std::span<double> out) = 0;
};

/// The approximate inverse D^-1 + B of a body's matrix: D is made of small diagonal blocks (the smoother); B is any
/// other approximation (the coarse level), or zero.
class BodyPreconditioner {
public:
    virtual ~BodyPreconditioner() = default;
    virtual void smooth() = 0; ///< w = D^-1 r, s = r
    /// z = w + B (s - F shares), with the coefficients `shares` of the deflation columns, if there are any. Returns r .
    /// z.
    virtual double applyCoarse(std::span<const double> shares) = 0;
    virtual void subtractSmoothed(std::span<const Vec3> impulses) = 0;       ///< z -= D^-1 impulses
    [[nodiscard]] virtual DeflationOperator* deflation() { return nullptr; } ///< null if B cannot be deflated
};

/// A body of a coupled solve.
struct CoupledBody {
    BodyOperator* matrix = nullptr;
    BodyPreconditioner* preconditioner = nullptr;
};
template <class Body> CoupledBody coupled(Body& body) { return {&body, &body}; }

} // namespace filasofia::engine
