#pragma once

#include "filasofia/math/mat3.h"

#include <span>

namespace filasofia::engine {

/// Where a constraint takes hold of a body: a node of a soft one, an element of a rigid one with the way from its
/// centre of mass [m, world axes]; of an articulated one, whose links are all moved by the same unknowns (node 0), a
/// link with the way from its origin, or a joint itself.
struct Grip {
    int node = 0;
    Vec3 arm = {};
    int link = 0; ///< of an articulated body; of joint j: -1 - j
};

/// One body's share of a solve that spans several. Whatever its integrator and its solver are, it has a symmetric
/// positive definite matrix A over the change of its velocities, an approximate inverse D^-1 + B of it, D made of small
/// blocks on the diagonal, B any other (or nothing), and the vectors of the conjugate gradients:
///
///     x answer, r residual, p direction, q = A p, w = D^-1 r, z the preconditioned residual.
///
/// Sums over a body come in joules and impulses at its grips in newton seconds, whatever scale it computes in.
class CoupledBody {
public:
    virtual ~CoupledBody() = default;

    /// x = 0, r = the right-hand side, p = a first guess. From now on the body is held at these grips.
    virtual void begin(std::span<const Grip> grips) = 0;
    /// D^-1 as seen from a grip [1/kg], world axes.
    [[nodiscard]] virtual Mat3 compliance(int grip) const = 0;
    [[nodiscard]] virtual double mass() const = 0; ///< [kg] of what moves

    virtual double multiply() = 0;          ///< q = A p; returns p . q
    virtual double slope() = 0;             ///< p . r
    virtual void descend(double alpha) = 0; ///< x += alpha p, r -= alpha q
    virtual void turn(double beta) = 0;     ///< p = z + beta p
    virtual void smooth() = 0;              ///< w = D^-1 r
    /// z = w + B (r + what was added - F shares), the shares of its pulls, if any; returns r . z
    virtual double spread(std::span<const double> shares) = 0;
    virtual double bent() = 0; ///< z . q

    // At the grips.
    virtual void readDirection(std::span<Vec3> p) const = 0;
    virtual void readSmoothed(std::span<Vec3> w) const = 0;
    virtual void readSpread(std::span<Vec3> z) const = 0;
    virtual void addToResidual(std::span<const Vec3> impulses) = 0;    ///< to r
    virtual void addToSpread(std::span<const Vec3> impulses) = 0;      ///< to what B will be applied to, r left alone
    virtual void subtractSmoothed(std::span<const Vec3> impulses) = 0; ///< z -= D^-1 impulses

    // Pulls at the grips, by which B can be corrected; only of bodies with a B that bears it.
    [[nodiscard]] virtual bool correctable() const { return false; }
    virtual void clearPulls() {}
    virtual void addPull(std::span<const Vec3>) {}        ///< [N s] another column of F
    virtual void answerPulls() {}                         ///< they are all there
    virtual void answers(int, std::span<double>) const {} ///< [J] of a pull, per pull: F^T B F
    virtual void weigh(std::span<double>) {}              ///< [J] per pull: F^T B (r + what was added), before spread()
};

} // namespace filasofia::engine
