#pragma once

#include "filasofia/engine/constraint/body_operator.h"
#include "filasofia/engine/constraint/coarse_correction.h"
#include "filasofia/engine/constraint/constraint.h"
#include "filasofia/engine/constraint/constraint_filter.h"
#include "filasofia/engine/constraint/impulse_sweeps.h"
#include "filasofia/linalg/dense_cholesky.h"
#include "filasofia/linalg/matrix_free_cg.h"

#include <algorithm>
#include <optional>
#include <vector>

namespace filasofia::engine {

/// Penalty times the compliance of the contact points, [-].
struct Kappa {
    double contact = 10.0; ///< of unilateral constraints
    double holding = 10.0; ///< of bilateral ones
};

/// [-] Kappa of contacts where all bodies are rigid. They may have no room, which the constraint's `trappedYielding`
/// and `trappedLoss` are chosen for at this kappa.
inline constexpr double kRigidKappa = 1e4;

/// Limits and parameters of a coupled solve.
struct CoupledLimits {
    linalg::SolveLimits linear{.smallAnswer = 1e-3}; ///< for all iterations together
    /// Iterations in which impulses are projected onto the constraint law; after them, the active set is frozen, or
    /// sweeps take over.
    int nonlinear = 40;
    bool sweeps = false; ///< all bodies are rigid elements or articulations
    /// Maximum number of updates, made while constraints exceed their tolerance. There are more while one is far off.
    int multiplierUpdates = 3;
    double tolerance = 5e-3; ///< [-] change of the impulses, relative to all impulses
    Kappa kappa = {};
    /// The same for constraints between bodies whose D is A, if the filter knows all constraints together from the
    /// start: they cost no iterations, however stiff they are.
    Kappa exactKappa = {};
    double bearing = 0.0; ///< [-] minimum penalty, relative to the mass of the heaviest body
};

/// `residual` is defined as for one body; after sweeps it is the share of the impulses that the last one changed.
struct CoupledReport : linalg::NodeSolveReport {
    bool apart = false;    ///< what is tied hard misses by far what it is to do, though the solve may have converged
    int rounds = 0;        ///< 1, plus 1 per multiplier update, plus 1 if the active set was frozen or swept
    double mismatch = 0.0; ///< [-] distance of the impulses from their law, relative to the largest; 0 if satisfied
};

/// Solves, for all bodies together,
///
///     A dv = b + J^T impulse,   impulse as the constraint law has it for the velocities v + dv,
///
/// with an augmented Lagrangian (Alart and Curnier 1991): with y = multiplier - Sigma (bias + u), a unilateral
/// constraint is active if y pushes, and slides if y leaves the friction cone. Sigma is kappa over the compliance of
/// the contact points, or more if light bodies must bear heavy ones.
///
///     A, dv, b   a body's matrix [kg], change of velocities [m/s] and right-hand side [N s] (BodyOperator)
///     J, F       a constraint's rows and its frame (ConstraintRow, Constraint); u = F J (v + dv)
///     Sigma      [kg] penalty per axis of the frame; y, impulse [N s] in the frame
///
/// The solver is a nonlinear conjugate gradient method. The impulses are projected onto the constraint law after every
/// iteration, so the residual is that of the problem itself, friction included, and tells when it is solved. Along a
/// direction the friction cones keep their radius (Tresca's law). There is then a convex, piecewise quadratic energy,
/// and the line search for its minimum costs no more than evaluating the law at the contacts. After the line search the
/// cones' radii follow the normal impulses again. The next direction is conjugate to the last one with respect to the
/// change of forces measured along it (Hestenes and Stiefel 1952), even if contacts have begun to touch or to slide
/// meanwhile.
///
/// Coulomb's law has no potential. The difference to Tresca's law is left to the iteration, which converges as long as
/// friction does not feed back more than it takes. Where it does, as in stiff tissue that slides with a coefficient
/// near 1, the impulses swing without end. If the residual has not fallen by half for 24 iterations, the radii of the
/// cones of contacts that pushed in the last step are those of its normal impulses from then on (lagged friction, Li et
/// al. 2020): what is left to swing are contacts that are new. The contacts remember it, and the next solves begin so,
/// until one takes at most two iterations. If the solve has not converged after `nonlinear` iterations, the active set
/// and the slip are frozen, once: the problem is linear then, and conjugate gradients always solve it. Between rigid
/// bodies, whose filter is exact, sweeps take over in place of that (ImpulseSweeps).
///
/// The caller carries the multipliers to the next step. If that is too late, as in an impact, the multipliers are set
/// to the impulses found, and the solve goes on.
///
/// The preconditioner filters the stiff contact directions out of the smoother and the coarse level: with N = sum |w| s
/// F D^-1 F^T per constraint, s the sum of the weights that share a contact point, and M = (1 + Sigma N)^-1 Sigma,
///     q = D^-1 r + B (r - J^T M J D^-1 r),   z = q - D^-1 J^T M J q.
/// The slower the solve, the more it knows of the constraints, as that costs about as much as some iterations:
///     at once, if any constraint is bilateral, or after 4 iterations: B is deflated by rigid motions of patches
///         (CoarseCorrection)
///     after 16 iterations, or six very short steps, if few bodies have a coarse level: B is deflated by the motions of
///         all coarse nodes that constraints follow, and M is that of all constraints together (ConstraintFilter)
/// If D is A in all bodies, there is no B, and M is that of all constraints together at once: z is then the solution
/// for the constraints that are active. If a body's D couples its nodes, as a rod's does, that M is used from the
/// start, too.
class CoupledSolve {
public:
    /// `pointsOf[b]` are the contact points of body b; rows index them as one list, in the order of the bodies. Leaves
    /// x in the bodies, and impulse and multiplier in the constraints. `ties`: what coarse levels know of constraints
    /// that are `tied`.
    CoupledReport solve(const CoupledLimits& limits, const std::vector<CoupledBody>& bodies,
                        const std::vector<std::vector<ContactPoint>>& pointsOf, const ConstraintRows& rows,
                        std::span<const SolvedTie> ties = {});

private:
    struct Row {                    ///< scratch of a constraint, in the order of the rows
        ConstraintLaw law;          ///< a copy: constraints are large, and every pass over the rows reads this
        Vec3 stiffness;             ///< [kg] Sigma of an active constraint
        Vec3 impulse;               ///< [N s] impulse that acts
        std::optional<double> cone; ///< [N s] radius of the friction cone while friction lags; none: it follows
        Vec3 along;                 ///< [m/s] velocity of the direction, in the frame; of rows that are awake
        Vec3 change;                ///< [N s] change of the impulse along the direction, for cones of fixed radius
        Vec3 passed;                ///< [N s] last change of the impulse
        bool trapped = false; ///< a contact of which only one side can move: its impulse may have grown without bound
        Projected now;        ///< the current projection onto the law
        Projected state;      ///< the projection when the filter was built
        Vec3 sigma;           ///< [kg] Sigma in that state: zero if inactive, less if sliding
    };

    /// Most contacts are only near and do not push. What tells that, and nothing else, is read of them in every pass.
    struct Normal {
        Vec3 axis;              ///< the normal
        double impulse = 0.0;   ///< [N s] that the solve starts from
        double stiffness = 0.0; ///< [kg]
        double velocity = 0.0;  ///< [m/s] bias + u
        double along = 0.0;     ///< [m/s] velocity of the direction
        bool sleeps = false;    ///< unilateral, without impulse
        bool active = false;    ///< when the filter was built
    };
    /// Whether a row that sleeps would still do so after this length of the direction.
    [[nodiscard]] bool staysAsleep(std::size_t c, double length) const
    {
        const Normal& at = normals_[c];
        return at.sleeps && !activeSetFrozen_ && at.impulse - at.stiffness * (at.velocity + length * at.along) <= 0.0;
    }

    /// What a constraint acts on on one side; nothing if nothing can move there.
    struct Side {
        std::optional<std::size_t> body;
        double along = 0.0; ///< [1/kg] compliance along the normal
        double inAll = 0.0; ///< [1/kg] summed over all directions
    };
    /// What attachments and tissue do to a body whose D is A: D knows it as free.
    struct Hold {
        bool pushes = false;                  ///< at tissue
        std::vector<std::size_t> attachments; ///< rows; empty: nothing holds it
        std::vector<Vec3> answers;            ///< [1/kg] D^-1 at its points, per attachment and axis
        linalg::DenseCholesky factor;         ///< the compliance of the attachments, factorised
    };

    /// What a body whose D is A bears beside its own inertia: another body that is fixed to it, or pushes at it.
    struct Burden {
        std::optional<std::size_t> other; ///< none: what cannot move
        double own = 0.0;                 ///< [kg] the other's inertia at the constraints between the two
        double all = 0.0;                 ///< [kg] with what it bears in turn
    };

    void begin(const std::vector<std::vector<ContactPoint>>& pointsOf);
    [[nodiscard]] std::size_t bodyOf(int point) const; ///< index of the body that a contact point is of
    [[nodiscard]] static std::size_t sideOf(const WeightedPoint& point) { return point.weight < 0.0 ? 1 : 0; }
    [[nodiscard]] std::array<Side, 2> sidesOf(const ConstraintRow& row) const;
    void findHolds();
    /// Whether the body on this side bears what is fixed to it or pushes at it: a rigid one or a rod.
    [[nodiscard]] bool bears(std::size_t c, std::size_t side) const;
    void findBurdens();
    /// [kg] The inertia on one side of a row: that of the body, and of what else is fixed to it or rests on it.
    [[nodiscard]] double inertiaAt(std::size_t c, std::size_t side) const;
    [[nodiscard]] double burdened(std::size_t c, double free) const; ///< [1/kg] what is left of a row's compliance
    void measureHold(std::size_t body);
    [[nodiscard]] bool isHeld(const Side& side) const;
    [[nodiscard]] Mat3 takenByHold(std::size_t c, std::size_t side); ///< [1/kg] by which a held body yields less there
    /// [1/kg] The compliance of a row along the normal that Sigma follows: that of bodies as they are held, or with
    /// what they bear; less for rods on tissue.
    [[nodiscard]] double compliancePressed(std::size_t c, double kappa);
    void chooseStiffness();
    /// The smoother of the body that a contact point is of; `point` becomes its number in the body.
    const BodySmoother& smootherAt(int& point) const;
    [[nodiscard]] bool isExact(const ConstraintRow& row) const; ///< the filter is the inverse for what it acts on
    /// [-] In [0, 1]: how far the sides of a contact between links of one body can part along the normal, relative to
    /// all that they can move against each other; 1 for all others.
    [[nodiscard]] double parting(const ConstraintRow& row, const std::array<Side, 2>& sides) const;
    [[nodiscard]] double ownStiffness(const ConstraintRow& row); ///< [kg] D of the blocks that a row acts on
    void blendRotations();  ///< of the bodies whose nodes have turned against each other
    void joinConstraints(); ///< filter and coarse levels know all of them together from now on
    void makeFilter();
    void applyFilter(const std::vector<Vec3>& velocities); ///< impulses_ = M of these, at the active rows
    void correctCoarseLevels();
    [[nodiscard]] ConstraintNetwork network() const { return {*bodies_, first_, *constraints_, filters_}; }
    [[nodiscard]] static bool isOther(const Projected& now, const Projected& then); ///< for the filter
    void renewFilter();                                       ///< rebuilds it if states have changed since
    void read(SolveVector from);                              ///< atPoints_ = this vector of the bodies
    [[nodiscard]] Vec3 velocityOf(std::size_t c) const;       ///< J atPoints_, world axes
    void readActive(SolveVector from, std::vector<Vec3>& to); ///< J of this vector of the bodies, at the active rows
    /// Calls add(body, its part of J^T impulses_) with the impulses of these rows, `factor` times.
    template <class Add> void push(double factor, const std::vector<std::size_t>& rows, const Add& add);
    void moveAlong(double length); ///< the rows' velocities
    [[nodiscard]] Vec3 velocityIn(std::size_t c) const { return inFrame(rows_[c].law.frame, velocities_[c]); } ///< u
    double changesAlong(double length); ///< sum of along . change of the impulses; lists the rows that have any
    [[nodiscard]] Vec3 reaction(std::size_t c, Vec3 u) const; ///< y
    [[nodiscard]] double coneAt(std::size_t c, Vec3 y) const; ///< [N s] radius of the friction cone
    [[nodiscard]] Projected law(std::size_t c, Vec3 u) const;
    [[nodiscard]] Vec3 lawAlong(std::size_t c, Vec3 u) const; ///< the law along a direction, which has an energy
    double multiply();
    void firstGuess();
    double precondition();
    bool impulsesSettled() const;
    bool updateDirection(double rz); ///< false if the direction has no positive curvature
    void lineSearch();
    void projectImpulses();            ///< onto the constraint law; `scratch`: their change
    [[nodiscard]] bool mayLag() const; ///< whether friction acts that does not lag yet
    void lagFriction();                ///< the radii of the friction cones are those of the last step from now on
    void rememberLag(const CoupledReport& report); ///< in the contacts, for the next solve
    void freezeActiveSet();
    void solveForImpulses();
    [[nodiscard]] bool sweepsAwake(std::size_t c, Vec3 u) const;
    double sweepOnce(double part, double& mismatch);
    bool sweep(CoupledReport& report); ///< until the impulses settle; false if D is not positive definite
    [[nodiscard]] bool isOutOfTime(int iterations) const;
    void beginAnew();                                 ///< from the solution so far, after the law has changed
    [[nodiscard]] double missOf(std::size_t c) const; ///< [-] how far a rigid constraint is off, in tolerances
    [[nodiscard]] bool weldsAreWithin(double tolerances) const;
    [[nodiscard]] bool holdsWell() const;     ///< what is welded: without taking a step
    [[nodiscard]] bool holdsTogether() const; ///< the same: well enough for what has converged
    bool updateMultipliers(int made);         ///< after so many updates; false if none is needed, or helps
    [[nodiscard]] double mismatch() const;
    [[nodiscard]] Vec3 carried(std::size_t c) const; ///< [N s] the multiplier that the next step starts from

    [[nodiscard]] const Constraint& constraint(std::size_t c) const { return *constraints_->list[c].constraint; }
    [[nodiscard]] std::span<Vec3> ofBody(std::size_t b) ///< the part of atPoints_
    {
        return std::span(atPoints_).subspan(static_cast<std::size_t>(first_[b]),
                                            static_cast<std::size_t>(first_[b + 1] - first_[b]));
    }

    const CoupledLimits* limits_ = nullptr;
    const std::vector<CoupledBody>* bodies_ = nullptr;
    const ConstraintRows* constraints_ = nullptr;
    std::vector<int> first_;     ///< per body: its first contact point; last, the total number
    std::vector<double> masses_; ///< [kg] per body
    std::vector<Vec3> atPoints_; ///< per contact point
    std::vector<int> sharing_;   ///< per contact point: the first one with the same unknowns
    std::vector<double> shares_;
    std::vector<Mat3> compliance_; ///< [1/kg] per contact point
    std::vector<std::array<Side, 2>> sides_;
    std::vector<Hold> holds_;                  ///< per body
    std::vector<std::vector<Burden>> burdens_; ///< per body; none of tissue
    double whole_ = 0.0;                       ///< [kg] the mass of all bodies
    std::vector<double> held_;                 ///< scratch of takenByHold()
    // What the passes over all rows read lies apart from the rest: a thousand rows do not fit into a core's cache
    // beside a body. Vectors per row are in world axes.
    std::vector<Row> rows_;
    std::vector<Normal> normals_;
    std::vector<std::size_t> active_;   ///< rows that were active when the filter was built
    std::vector<std::size_t> changing_; ///< rows with a change along the direction
    std::vector<std::size_t> passing_;  ///< rows whose impulse was changed last
    std::size_t others_ = 0;            ///< number of rows that have another state than when the filter was built
    std::vector<Vec3> velocities_;      ///< [m/s] u
    std::vector<Vec3> alongs_;          ///< [m/s] velocity of the direction
    std::vector<Vec3> steps_;           ///< [m/s] velocity of z
    std::vector<Vec3> smoothed_;        ///< [m/s] velocity of D^-1 r, at active rows
    std::vector<Vec3> impulses_;        ///< [N s] scratch
    std::vector<Mat3> filters_;         ///< [kg] M of single constraints; zero if they are not active
    ImpulseSweeps sweeps_;
    ConstraintFilter filter_;           ///< M of all constraints together
    bool together_ = false;             ///< it is used in place of those of single constraints
    bool exact_ = false;                ///< D is A in all bodies
    bool blended_ = false;              ///< blendRotations() was called
    bool joined_ = false;               ///< the coarse levels know all constraints together, as far as they can
    std::vector<Vec3> perRow_;          ///< scratch of the filter
    std::vector<BlockColumns> columns_; ///< scratch of ownStiffness()
    CoarseCorrection correction_;
    double energy_ = 0.0, smallest_ = 0.0;

    bool frictionLags_ = false;    ///< behind the normal impulses: the friction cones keep their radii
    bool activeSetFrozen_ = false; ///< the active set is frozen, and the law is linear
    bool swept_ = false;           ///< the impulses are those of sweeps
    double missed_ = 0.0;          ///< by the worst constraint at the last update, relative to its tolerance
    bool restart_ = true;          ///< the next direction is conjugate to no other
    double ownCurvature_ = 0.0;    ///< p . A p
    double curvature_ = 0.0;       ///< p . (A + J^T Sigma J) p
    double derivative_ = 0.0;      ///< the energy's decrease per length at the start of the direction
    double lastDerivative_ = 0.0;  ///< the same for the previous direction
    double length_ = 0.0;          ///< length of the step along the direction
    double derivativeAtEnd_ = 0.0; ///< derivative there, for cones of fixed radius
    double derivativeAfter_ = 0.0; ///< derivative there, with the current cones
};

template <class Add> void CoupledSolve::push(double factor, const std::vector<std::size_t>& rows, const Add& add)
{
    std::ranges::fill(atPoints_, Vec3{});
    for (std::size_t c : rows) addImpulse(*constraints_, c, factor * impulses_[c], atPoints_);
    for (std::size_t b = 0; b < bodies_->size(); ++b) add((*bodies_)[b], ofBody(b));
}

} // namespace filasofia::engine
