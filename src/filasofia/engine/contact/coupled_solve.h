#pragma once

#include "filasofia/engine/contact/constraint.h"
#include "filasofia/engine/contact/coupled_body.h"
#include "filasofia/linalg/matrix_free_cg.h"

#include <vector>

namespace filasofia::engine {

/// How a coupled solve is made.
struct CoupledLimits {
    linalg::SolveLimits linear; ///< of all rounds' iterations together
    int rounds = 8;             ///< of finding out what touches and what slides
    int raises = 3;             ///< of impulses that would miss what constraints want by more than their slack
    double tolerance = 5e-3;    ///< [-] of impulses, relative to the largest
    double stiffening = 10.0;   ///< [-] kappa: penalty over what the grips give by themselves
    double holding = 10.0;      ///< [-] the same of what is held
    double smallChange = 1e-3;  ///< [m/s] a change of velocity whose energy errors are measured by, when nothing moves
};

/// `residual` as for one body; `converged`: of the equations of motion.
struct CoupledReport : linalg::NodeSolveReport {
    int rounds = 0;
    double mismatch = 0.0; ///< [-] impulses short of the law, relative to the largest
};

/// Solves, for all bodies together,
///
///     A dv = b + J^T impulse,   impulse as the constraints' law has it for the velocities v + dv,
///
/// by an augmented Lagrangian inside the conjugate gradients (Alart and Curnier 1991; a semi-smooth Newton method):
/// with y = impulse_before - Sigma (bias + u), a constraint is active where y pushes, slides where y leaves the cone,
/// and for given states the law is linear: the matrix gains J^T Sigma J. Sigma = kappa over the compliance of the
/// grips. Rounds go on until the linear law and the true one agree; where they do not, the way is shortened to where
/// the energy (convex, piecewise quadratic) is least. The multipliers are carried to the next step by the caller;
/// where that would be too late, as in an impact, impulse_before is raised to what was found, and rounds begin again.
///
/// The preconditioner filters the stiff contact directions out of the smoother and the coarse level: with
/// N = sum |w| s F D^-1 F^T per contact, s the weights that share a grip, and M = (1 + Sigma N)^-1 Sigma,
///     q = D^-1 r + B (r - J^T M J D^-1 r),   z = q - D^-1 J^T M J q.
class CoupledSolve {
public:
    /// `gripsOf[b]`: the grips of body b; their places in one list follow from that order. Leaves x in the bodies and
    /// impulses in the constraints.
    CoupledReport solve(const CoupledLimits& limits, const std::vector<CoupledBody*>& bodies,
                        const std::vector<std::vector<Grip>>& gripsOf, Constraints& constraints);

private:
    struct Row {                  ///< of a constraint, in the order of the list
        Vec3 stiffness;           ///< [kg] Sigma of an active constraint
        Vec3 sigma;               ///< [kg] as it is now: zero where inactive, less where it slides
        Mat3 filter;              ///< M
        Vec3 u, uSaved, along;    ///< [m/s] velocity, before the round, of the direction
        Vec3 linear, linearSaved; ///< [N s] the impulse of the linear law
        Vec3 probe;               ///< of the filter
    };
    using Read = void (CoupledBody::*)(std::span<Vec3>) const;
    using Add = void (CoupledBody::*)(std::span<const Vec3>);

    void begin(const std::vector<std::vector<Grip>>& gripsOf);
    void chooseStiffness();
    void makeFilter();
    void gather(Read read);                             ///< at_ = what the bodies say at the grips
    [[nodiscard]] Vec3 velocityOf(std::size_t c) const; ///< F J at_
    template <class ImpulseOf> void giveImpulses(Add add, const ImpulseOf& impulseOf); ///< J^T F^T of them
    double multiply();
    double precondition();
    void descend(double alpha);
    [[nodiscard]] Projected law(std::size_t c, Vec3 u) const;
    void firstGuess();
    bool iterate(int cap, CoupledReport& report);
    bool agree(CoupledReport& report);
    bool raiseImpulses(); ///< false where there is no need
    void shorten();

    const CoupledLimits* limits_ = nullptr;
    const std::vector<CoupledBody*>* bodies_ = nullptr;
    Constraints* constraints_ = nullptr;
    std::vector<int> first_;   ///< per body: its first grip in at_
    std::vector<Vec3> at_;     ///< per grip
    std::vector<int> sharing_; ///< per grip: the first one with the same unknowns
    std::vector<double> shares_;
    std::vector<Mat3> compliance_; ///< per grip
    std::vector<Row> rows_;
    double energy_ = 0.0, smallest_ = 0.0;
};

} // namespace filasofia::engine
