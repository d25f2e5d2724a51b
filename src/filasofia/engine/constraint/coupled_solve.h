#pragma once

#include "filasofia/engine/constraint/body_operator.h"
#include "filasofia/engine/constraint/constraint.h"
#include "filasofia/engine/constraint/patch_correction.h"
#include "filasofia/linalg/matrix_free_cg.h"

#include <algorithm>
#include <vector>

namespace filasofia::engine {

/// How a coupled solve is made.
struct CoupledLimits {
    linalg::SolveLimits linear; ///< for all iterations together
    int nonlinear =
        40; ///< iterations in which impulses are projected onto their law; then the active set stays as it is
    int multiplierUpdates = 3; ///< at most, while constraints miss what they want by more than their tolerance
    double tolerance = 5e-3;   ///< [-] of the impulses, relative to all of them
    double stiffening = 10.0;  ///< [-] kappa: penalty over the compliance of the contact points; unilateral
    double holding = 10.0;     ///< [-] the same for bilateral constraints
    double bearing = 0.0;      ///< [-] the least penalty, over the mass of the heaviest body
    double smallChange = 1e-3; ///< [m/s] the change of velocity whose energy errors are measured by if nothing moves
};

/// `residual` as for one body.
struct CoupledReport : linalg::NodeSolveReport {
    int rounds = 0;        ///< one, another for each multiplier update, and one if the active set had to be kept
    double mismatch = 0.0; ///< [-] how far impulses are from their law, relative to the largest; 0 if they obey it
};

/// Solves, for all bodies together,
///
///     A dv = b + J^T impulse,   impulse as the constraints' law has it for the velocities v + dv,
///
/// with an augmented Lagrangian (Alart and Curnier 1991): with y = multiplier - Sigma (bias + u), a unilateral
/// constraint is active if y pushes, and slides if y leaves the friction cone. Sigma = kappa over the compliance of the
/// contact points, and what light bodies need to bear heavy ones.
///
///     A, dv, b   a body's matrix [kg], change of velocities [m/s] and right-hand side [N s] (BodyOperator)
///     J, F       a constraint's rows and its frame (ConstraintRow, Constraint); u = F J (v + dv)
///     Sigma      [kg] penalty per axis of the frame; y, impulse [N s] in the frame
///
/// The solver is a nonlinear conjugate gradient method: the impulses are projected onto their law after every
/// iteration, so that the residual is that of the problem itself and tells when it is solved, friction included. Along
/// a direction the friction cones keep their radius (Tresca's law). There is then an energy, convex and piecewise
/// quadratic, whose minimum is looked for at no more cost than the law at the contacts. Only then do the cones become
/// what the normal impulses say. The next direction is conjugate to the last one under the change of forces that it has
/// met (Hestenes and Stiefel 1952), whatever has begun to touch or to slide meanwhile. Coulomb's law has no potential;
/// what Tresca's law leaves out of it is left to the iteration, which converges as long as friction does not feed back
/// more than it takes. If it has not converged after `nonlinear` iterations, the active set and the slip are kept,
/// once: the problem is linear then, and conjugate gradients solve it in any case.
///
/// The caller carries the multipliers to the next step. If that would be too late, as in an impact, they are updated to
/// what was found, and the solve goes on.
///
/// The preconditioner filters the stiff contact directions out of the smoother and the coarse level: with
/// N = sum |w| s F D^-1 F^T per constraint, s the weights that share a contact point, and M = (1 + Sigma N)^-1 Sigma,
///     q = D^-1 r + B (r - J^T M J D^-1 r),   z = q - D^-1 J^T M J q.
/// If any constraint is bilateral, or a few iterations did not do, B is told of the constraints (PatchCorrection).
class CoupledSolve {
public:
    /// `pointsOf[b]`: the contact points of body b; their indices in one list follow from that order. Leaves x in the
    /// bodies, and impulse and multiplier in the constraints.
    CoupledReport solve(const CoupledLimits& limits, const std::vector<CoupledBody>& bodies,
                        const std::vector<std::vector<ContactPoint>>& pointsOf, const ConstraintRows& rows);

private:
    struct Row {           ///< scratch of a constraint, in the order of the rows
        Vec3 stiffness;    ///< [kg] Sigma of an active constraint
        Vec3 u;            ///< [m/s] velocity
        Vec3 impulse;      ///< [N s] what acts
        Vec3 step, along;  ///< [m/s] velocity of z; of the direction
        Vec3 change;       ///< [N s] of the impulse along the direction, for cones of fixed radius
        double cone = 0.0; ///< [N s] radius of the friction cone along the direction
        Projected now;     ///< what the law says
        Projected state;   ///< what the law said when the filter was made
        Vec3 sigma;        ///< [kg] Sigma in that state: zero if inactive, less if it slides
        Vec3 scratch;
    };

    void begin(const std::vector<std::vector<ContactPoint>>& pointsOf);
    void chooseStiffness();
    void makeFilter();
    void correctCoarseLevels();
    void renewFilter();                                 ///< if states have changed since it was made
    void gather(SolveVector from);                      ///< atPoints_ = that vector of the bodies
    [[nodiscard]] Vec3 velocityOf(std::size_t c) const; ///< F J atPoints_
    template <class Add, class ImpulseOf>
    void addImpulses(const ImpulseOf& impulseOf, const Add& add); ///< add(body, its part of J^T F^T impulses)
    [[nodiscard]] Vec3 reaction(std::size_t c, Vec3 u) const;     ///< y
    [[nodiscard]] Projected law(std::size_t c, Vec3 u) const;
    [[nodiscard]] Vec3 lawAlong(std::size_t c, Vec3 u) const; ///< along a direction: the law that has an energy
    double multiply();
    void firstGuess();
    double precondition();
    bool impulsesSettled() const;
    bool updateDirection(double rz); ///< false if no direction has a positive curvature
    void lineSearch();
    void projectImpulses(); ///< onto their law; `scratch`: by how much they change
    void keepStates();
    bool updateMultipliers(); ///< false if there is no need
    [[nodiscard]] double mismatch() const;

    [[nodiscard]] const Constraint& constraint(std::size_t c) const { return *constraints_->list[c].constraint; }

    const CoupledLimits* limits_ = nullptr;
    const std::vector<CoupledBody>* bodies_ = nullptr;
    const ConstraintRows* constraints_ = nullptr;
    std::vector<int> first_;     ///< per body: its first contact point; last, their number
    std::vector<double> masses_; ///< [kg] per body
    std::vector<Vec3> atPoints_; ///< per contact point
    std::vector<int> sharing_;   ///< per contact point: the first one with the same unknowns
    std::vector<double> shares_;
    std::vector<Mat3> compliance_;    ///< [1/kg] per contact point
    std::vector<Mat3> ownCompliance_; ///< [1/kg] per point of a constraint: in its frame, times |weight|
    std::vector<Row> rows_;
    std::vector<Mat3> filters_; ///< M, per constraint
    PatchCorrection patches_;
    double energy_ = 0.0, smallest_ = 0.0;

    bool statesKept_ = false;      ///< the law is linear from now on
    bool restart_ = true;          ///< the next direction is conjugate to none
    double ownCurvature_ = 0.0;    ///< p . A p
    double curvature_ = 0.0;       ///< p . (A + J^T Sigma J) p
    double derivative_ = 0.0;      ///< of the energy against the direction, where it begins
    double lastDerivative_ = 0.0;  ///< the same of the direction before
    double length_ = 0.0;          ///< of the step made along the direction
    double derivativeAtEnd_ = 0.0; ///< there, for cones of fixed radius
    double derivativeAfter_ = 0.0; ///< there, with the cones that there are now
};

template <class Add, class ImpulseOf> void CoupledSolve::addImpulses(const ImpulseOf& impulseOf, const Add& add)
{
    std::fill(atPoints_.begin(), atPoints_.end(), Vec3{});
    for (std::size_t c = 0; c < rows_.size(); ++c)
        if (const Vec3 impulse = impulseOf(c); impulse != Vec3{}) // most contacts are near, and do not push
            addImpulse(*constraints_, c, impulse, atPoints_);
    for (std::size_t b = 0; b < bodies_->size(); ++b)
        add((*bodies_)[b],
            std::span<const Vec3>(atPoints_).subspan(static_cast<std::size_t>(first_[b]),
                                                     static_cast<std::size_t>(first_[b + 1] - first_[b])));
}

} // namespace filasofia::engine
