#pragma once

#include "filasofia/engine/constraint/constraint.h"
#include "filasofia/engine/constraint/body_operator.h"
#include "filasofia/engine/constraint/patch_correction.h"
#include "filasofia/linalg/matrix_free_cg.h"

#include <algorithm>
#include <vector>

namespace filasofia::engine {

/// How a coupled solve is made.
struct CoupledLimits {
    linalg::SolveLimits linear; ///< of all iterations together
    int following = 40;         ///< iterations by which the law is followed; then what touches and slides stays
    int raises = 3;             ///< of impulses that would miss what constraints want by more than their slack
    double tolerance = 5e-3;    ///< [-] of impulses, relative to all of them
    double stiffening = 10.0;   ///< [-] kappa: penalty over what the grips give by themselves
    double holding = 10.0;      ///< [-] the same of what is held
    double bearing = 0.0;       ///< [-] that the penalty is at least, over the mass of the heaviest body
    double smallChange = 1e-3;  ///< [m/s] a change of velocity whose energy errors are measured by, when nothing moves
};

/// `residual` as for one body.
struct CoupledReport : linalg::NodeSolveReport {
    int rounds = 0;        ///< one, another after each raise, and one where the law could not be followed to the end
    double mismatch = 0.0; ///< [-] impulses short of the law, relative to the largest; 0 where it was followed
};

/// Solves, for all bodies together,
///
///     A dv = b + J^T impulse,   impulse as the constraints' law has it for the velocities v + dv,
///
/// an augmented Lagrangian (Alart and Curnier 1991): with y = impulse_before - Sigma (bias + u), a constraint is active
/// where y pushes, slides where y leaves the cone. Sigma = kappa over the compliance of the grips, and what light
/// bodies need to bear heavy ones.
///
/// By conjugate gradients that follow the law: the impulses are the lawful ones after every iteration, so that the
/// residual is that of the problem itself and tells when it is solved, touching, sliding and all. Along a direction the
/// cones of friction stay as wide as they were (Tresca's law): so there is an energy, convex and piecewise quadratic,
/// whose least is looked for at no more cost than the law at the contacts. Only then the cones become what the normal
/// impulses say. The next direction is conjugate to the last one under the change of forces that it has met (Hestenes
/// and Stiefel 1952), whatever has begun to touch or to slide meanwhile. What Coulomb's law has no symmetry for is left
/// to the iteration: it converges, as long as friction does not feed back more than it takes, and where it does not
/// for `following` iterations the law is replaced by its linear form, once, which conjugate gradients solve in any
/// case.
///
/// The multipliers are carried to the next step by the caller; where that would be too late, as in an impact,
/// impulse_before is raised to what was found, and the solve goes on.
///
/// The preconditioner filters the stiff contact directions out of the smoother and the coarse level: with
/// N = sum |w| s F D^-1 F^T per contact, s the weights that share a grip, and M = (1 + Sigma N)^-1 Sigma,
///     q = D^-1 r + B (r - J^T M J D^-1 r),   z = q - D^-1 J^T M J q.
/// Where something is held, and where a few iterations did not do, B is told of it (PatchCorrection).
class CoupledSolve {
public:
    /// `gripsOf[b]`: the grips of body b; their places in one list follow from that order. Leaves x in the bodies and
    /// impulses in the constraints.
    CoupledReport solve(const CoupledLimits& limits, const std::vector<CoupledBody*>& bodies,
                        const std::vector<std::vector<Grip>>& gripsOf, Constraints& constraints);

private:
    struct Row {           ///< of a constraint, in the order of the list
        Vec3 stiffness;    ///< [kg] Sigma of an active constraint
        Vec3 u;            ///< [m/s] velocity
        Vec3 impulse;      ///< [N s] what acts
        Vec3 step, along;  ///< [m/s] of z; of the direction
        Vec3 change;       ///< [N s] of the impulse along the direction, the cone as wide as it was
        double cone = 0.0; ///< [N s] that it bears across
        Projected now;     ///< what the law says
        Projected state;   ///< that the filter was made for
        Vec3 sigma;        ///< [kg] in that state: zero where inactive, less where it slides
        Vec3 probe;        ///< of the filter
    };
    using Read = void (CoupledBody::*)(std::span<Vec3>) const;
    using Add = void (CoupledBody::*)(std::span<const Vec3>);

    void begin(const std::vector<std::vector<Grip>>& gripsOf);
    void chooseStiffness();
    void makeFilter();
    void correctCoarseLevels();
    void renewFilter();                                 ///< where states have changed since it was made
    void gather(Read read);                             ///< at_ = what the bodies say at the grips
    [[nodiscard]] Vec3 velocityOf(std::size_t c) const; ///< F J at_
    template <class ImpulseOf> void giveImpulses(Add add, const ImpulseOf& impulseOf); ///< J^T F^T of them
    [[nodiscard]] Vec3 reaction(std::size_t c, Vec3 u) const;                          ///< Sigma's: y
    [[nodiscard]] Projected law(std::size_t c, Vec3 u) const;
    [[nodiscard]] Vec3 lawAlong(std::size_t c, Vec3 u) const; ///< along a direction: one that has an energy
    double multiply();
    void firstGuess();
    double precondition();
    bool impulsesSettled() const;
    bool turn(double rz); ///< false where there is nowhere to go
    void advance();
    void obey(); ///< the impulses become lawful; `probe`: by how much they change
    void keepStates();
    bool raiseImpulses(); ///< false where there is no need
    [[nodiscard]] double mismatch() const;

    const CoupledLimits* limits_ = nullptr;
    const std::vector<CoupledBody*>* bodies_ = nullptr;
    Constraints* constraints_ = nullptr;
    std::vector<int> first_;   ///< per body: its first grip in at_
    std::vector<Vec3> at_;     ///< per grip
    std::vector<int> sharing_; ///< per grip: the first one with the same unknowns
    std::vector<double> shares_;
    std::vector<Mat3> compliance_; ///< per grip
    std::vector<Mat3> give_;       ///< [1/kg] per grip of a constraint: compliance in its frame, times |weight|
    std::vector<Row> rows_;
    std::vector<Mat3> filters_; ///< M, per constraint
    PatchCorrection patches_;
    double energy_ = 0.0, smallest_ = 0.0;

    bool statesKept_ = false; ///< the law is linear from now on
    bool restart_ = true;     ///< the next direction is conjugate to none
    double own_ = 0.0;        ///< p . A p
    double bend_ = 0.0;       ///< the same with J^T Sigma J
    double slope_ = 0.0;      ///< of the direction, where it begins
    double lastSlope_ = 0.0;  ///< of the direction before
    double way_ = 0.0;        ///< made along it
    double end_ = 0.0;        ///< slope there, the cones as wide as they were
    double endNow_ = 0.0;     ///< the same with the cones that there are now
};

template <class ImpulseOf> void CoupledSolve::giveImpulses(Add add, const ImpulseOf& impulseOf)
{
    std::fill(at_.begin(), at_.end(), Vec3{});
    for (std::size_t c = 0; c < rows_.size(); ++c)
        if (const Vec3 impulse = impulseOf(c); impulse != Vec3{}) // most are near, and do not push
            giveImpulse(*constraints_, c, impulse, at_);
    for (std::size_t b = 0; b < bodies_->size(); ++b)
        ((*bodies_)[b]->*add)(std::span(at_).subspan(static_cast<std::size_t>(first_[b]),
                                                     static_cast<std::size_t>(first_[b + 1] - first_[b])));
}

} // namespace filasofia::engine
