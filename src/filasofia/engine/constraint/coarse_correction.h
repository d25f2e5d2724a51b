#pragma once

#include "filasofia/engine/constraint/constraint_motions.h"
#include "filasofia/engine/constraint/motion_matrix.h"
#include "filasofia/engine/constraint/tied_coarse.h"
#include "filasofia/linalg/column_panels.h"

#include <vector>

namespace filasofia::engine {

/// Deflates the bodies' coarse levels by the constraints between the bodies. The coarse level treats a body as free.
/// Without the correction, a soft body between jaws, or sewn to another, therefore takes more iterations the stiffer it
/// is (measured: 38 instead of 10 with forceps that pull at a polyp).
///
///     B' = B - B F S^-1 F^T B,   F = J^T M U,   S = U^T M U + F^T B F,
///
/// where M is the filter: the stiffness that the constraints keep for the coarse level after the smoother has yielded
/// to them; and U are motions of the constraints (Woodbury's formula). As F (U^T M U)^-1 F^T <= J^T M J, the correction
/// is never too large: B' stays positive definite, and is no softer than the exact inverse. If U are the motions of all
/// coarse nodes, B' is exact: (A_c + P^T J^T M J P)^-1 on the coarse nodes of all bodies together.
///
/// Attachments between soft bodies are known from step to step (TiedCoarse). With them, B is (B^-1 + E H E^T)^-1 from
/// the start, and the constraints that are left correct that:
///
///     B' s = B (s - E c) - B F a,   S a = F^T B s - T^T W y,   c = W y - W T a
///
/// where S is less by T^T W T, y = E^T B s is the answer of the picked coarse nodes, and T = E^T B F.
class CoarseCorrection {
public:
    /// Knows these ties, and no motions. The ties must outlive the solve.
    void begin(std::span<const SolvedTie> ties);
    [[nodiscard]] bool empty() const { return sums_.empty() && ties_.empty(); }
    [[nodiscard]] bool hasMotions() const { return !sums_.empty(); }

    void make(const ConstraintNetwork& network, std::vector<ConstraintMotions> motions);

    /// Computes the coefficients from the bodies' F^T B s, and corrects s for the ties. To be called between their
    /// smooth() and their applyCoarse().
    void project(std::span<const CoupledBody> bodies);
    /// The coefficients that applyCoarse() of this body takes.
    [[nodiscard]] std::span<const double> shares(std::size_t body) const;

private:
    struct Tie {
        const SolvedTie* tie = nullptr;
        std::vector<float> y, c;
        std::vector<float> t, wt;    ///< T and W T, motion after motion
        linalg::ColumnPanels panels; ///< T
        [[nodiscard]] std::span<float> tOf(std::size_t motion)
        {
            return std::span(t).subspan(motion * y.size(), y.size());
        }
        [[nodiscard]] std::span<float> wtOf(std::size_t motion)
        {
            return std::span(wt).subspan(motion * c.size(), c.size());
        }
        /// T^T c, valid until the next call
        std::span<const float> products(std::span<const float> impulses)
        {
            return panels.products(impulses.first(y.size()));
        }
    };
    void clearMotions();
    void addColumns(const ConstraintNetwork& network, const ConstraintMotions& motions, std::span<const Mat3> impulses,
                    std::size_t number);
    void addBody(DeflationOperator& deflation, std::size_t body);
    void addTies(std::span<const CoupledBody> bodies, std::size_t motions);
    void projectMotions(std::span<const CoupledBody> bodies);
    void answerTies(std::span<const CoupledBody> bodies);
    void subtractTies(std::span<const CoupledBody> bodies);

    std::vector<Tie> ties_;
    std::vector<std::vector<std::size_t>> threes_; ///< per body: which motions, three by three, reach it; ascending
    std::vector<std::vector<double>> shares_;      ///< per body, per column: three for each of these
    std::vector<Vec3> sums_;                       ///< per three motions
    std::vector<Vec3> column_;                     ///< scratch: a column of F, at all contact points
    MotionMatrix s_;
};

} // namespace filasofia::engine
