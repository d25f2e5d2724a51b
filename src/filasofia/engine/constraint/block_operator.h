#pragma once

#include "filasofia/engine/constraint/dense_operator.h"
#include "filasofia/linalg/block_sparse_matrix.h"
#include "filasofia/linalg/linear_solver.h"

#include <vector>

namespace filasofia::engine {

/// The input of a BlockOperator. Everything that it points to must outlive the solve.
struct BlockOperatorInput {
    std::span<const Mat3> diagonal = {};               ///< [kg] D, one 3x3 block per unknown vector
    const linalg::BlockSparseMatrix* matrix = nullptr; ///< A; if null, A is D
    linalg::LinearSolver* solver = nullptr;            ///< applies the coarse level B = A^-1; if null, there is no B
    std::span<const Vec3> rightHandSide = {};          ///< [N s]
    std::span<const Vec3> guess = {};                  ///< [m/s] first guess; empty if there is none
    double mass = 0.0;                                 ///< [kg] mass of the moving part
    bool turning = false; ///< unknowns come in pairs: a rigid body's velocity and its angular velocity
};

/// The operator of a body whose matrix is stored as 3x3 blocks, or is the diagonal of its masses: bodies with explicit
/// integration, rigid bodies, and bodies with a solver of their own choice.
class BlockOperator final : public DenseOperator<Vec3> {
public:
    explicit BlockOperator(const BlockOperatorInput& in);

    double begin(std::span<const ContactPoint> points) override;
    void read(SolveVector from, std::span<Vec3> out) const override;
    void add(std::span<const Vec3> impulses, SolveVector to) override;
    double multiply() override;

    [[nodiscard]] Mat3 compliance(int point) const override;
    void addColumns(int point, std::vector<BlockColumns>& out) const override;
    [[nodiscard]] Mat3 block(int row, int) const override { return in_.diagonal[static_cast<std::size_t>(row)]; }
    [[nodiscard]] bool isExact() const override { return !in_.matrix; }

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
