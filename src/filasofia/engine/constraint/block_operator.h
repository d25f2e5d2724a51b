#pragma once

#include "filasofia/engine/constraint/dense_operator.h"
#include "filasofia/linalg/block_sparse_matrix.h"
#include "filasofia/linalg/linear_solver.h"

#include <vector>

namespace filasofia::engine {

/// What a BlockOperator computes with. All of it outlives the solve.
struct BlockOperatorInput {
    std::span<const Mat3> diagonal = {};               ///< [kg] D, a block per unknown vector
    const linalg::BlockSparseMatrix* matrix = nullptr; ///< A; null: A is D
    linalg::LinearSolver* solver = nullptr;            ///< B = A^-1 by it; null: no B
    std::span<const Vec3> rightHandSide = {};          ///< [N s]
    std::span<const Vec3> guess = {};                  ///< [m/s] empty: none
    double mass = 0.0;                                 ///< [kg] of what moves
    bool turning = false; ///< unknowns are pairs: an element's velocity and angular velocity
};

/// A body whose matrix is written out in 3x3 blocks, or is just its masses: explicit bodies, rigid ones, and those with
/// a solver of their own choice.
class BlockOperator final : public DenseOperator<Vec3> {
public:
    explicit BlockOperator(const BlockOperatorInput& in);

    double begin(std::span<const ContactPoint> points) override;
    [[nodiscard]] Mat3 compliance(int point) const override;
    void read(SolveVector from, std::span<Vec3> out) const override;
    void add(std::span<const Vec3> impulses, SolveVector to) override;
    double multiply() override;

    void smooth() override;
    double applyCoarse(std::span<const double> shares) override;
    void subtractSmoothed(std::span<const Vec3> impulses) override;

private:
    void addTo(Vector& to, std::span<const Vec3> impulses) const;
    [[nodiscard]] std::size_t unknownOf(const ContactPoint& point) const
    {
        return static_cast<std::size_t>(in_.turning ? 2 * point.node : point.node);
    }

    BlockOperatorInput in_;
    std::vector<Mat3> inverse_; ///< D^-1
    std::vector<ContactPoint> points_;
    Vector s_; ///< the residual that B is applied to
};

} // namespace filasofia::engine
