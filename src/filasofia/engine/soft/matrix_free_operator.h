#pragma once

#include "filasofia/engine/constraint/body_operator.h"
#include "filasofia/engine/soft/matrix_free_system.h"

namespace filasofia::engine {

/// The body operator of a matrix-free body, for coupled solves.
class MatrixFreeOperator final : public BodyOperator,
                                 public BodySmoother,
                                 public BodyPreconditioner,
                                 private DeflationOperator {
public:
    explicit MatrixFreeOperator(MatrixFreeSystem& system);

    /// `dv` [m/s]: the first guess. The pool must outlive the solve.
    void prepare(std::span<const Vec3> dv, WorkerPool& pool);

    double begin(std::span<const ContactPoint> points) override;
    void read(SolveVector from, std::span<Vec3> out) const override;
    void add(std::span<const Vec3> impulses, SolveVector to) override;
    double multiply() override;
    double dot(SolveVector a, SolveVector b) override;
    void step(double alpha) override;
    void updateDirection(double beta) override;

    [[nodiscard]] Mat3 compliance(int point) const override;
    void addColumns(int point, std::vector<BlockColumns>& out) const override;
    [[nodiscard]] Mat3 block(int row, int column) const override;

    void smooth() override;
    double applyCoarse(std::span<const double> shares) override;
    void subtractSmoothed(std::span<const Vec3> impulses) override;
    bool blendRotations() override;
    [[nodiscard]] DeflationOperator* deflation() override { return system_.coarseNodes() > 0 ? this : nullptr; }

private:
    void addCoarseColumns(int point, std::vector<BlockColumns>& out) const override;
    void clear() override { system_.preconditioner_.clearColumns(); }
    void addColumn(std::span<const Vec3> impulses) override;
    void finish() override { system_.preconditioner_.finishColumns(); }
    void products(int column, std::span<double> out) override;
    void project(std::span<double> out) override;
    void readColumn(int column, std::span<const int> coarseNodes, std::span<float> out) const override;
    void readAnswer(std::span<const int> coarseNodes, std::span<float> out) override;
    void subtract(std::span<const int> coarseNodes, std::span<const float> impulses) override;

    void readFrom(const linalg::NodeArray& vector, std::span<Vec3> out) const;
    double product(const linalg::NodeArray& a, const linalg::NodeArray& b);

    MatrixFreeSystem& system_;
    WorkerPool* pool_ = nullptr;
    double mass_ = 0.0;                       ///< [kg] of the free nodes, as of prepare()
    std::vector<int> slots_;                  ///< per contact point
    std::vector<Mat3> inverse_;               ///< D^-1 there, scaled
    std::vector<linalg::ColumnEntry> column_; ///< scratch
    linalg::NodeArray z_, p_, q_;
};

} // namespace filasofia::engine
