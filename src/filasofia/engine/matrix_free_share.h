#pragma once

#include "filasofia/engine/contact/coupled_body.h"
#include "filasofia/engine/matrix_free_system.h"

namespace filasofia::engine {

/// A matrix-free body's share of a solve that spans several.
class MatrixFreeShare final : public CoupledBody {
public:
    explicit MatrixFreeShare(MatrixFreeSystem& system);

    /// `dv`: the first guess. The pool is used until the solve is over.
    void prepare(std::span<const Vec3> dv, WorkerPool& pool);

    void begin(std::span<const Grip> grips) override;
    [[nodiscard]] Mat3 compliance(int grip) const override;
    [[nodiscard]] double mass() const override { return mass_; }
    double multiply() override;
    double slope() override;
    void descend(double alpha) override;
    void turn(double beta) override;
    void smooth() override;
    double spread(std::span<const double> shares) override;
    double bent() override { return product(z_, q_); }
    void readDirection(std::span<Vec3> p) const override { read(p_, p); }
    void readSmoothed(std::span<Vec3> w) const override;
    void readSpread(std::span<Vec3> z) const override { read(z_, z); }
    void addToResidual(std::span<const Vec3> impulses) override { add(impulses, system_.residual_); }
    void addToSpread(std::span<const Vec3> impulses) override;
    void subtractSmoothed(std::span<const Vec3> impulses) override;
    [[nodiscard]] bool correctable() const override { return system_.coarseNodes() > 0; }
    void clearPulls() override { system_.preconditioner_.clearColumns(); }
    void addPull(std::span<const Vec3> impulses) override;
    void answerPulls() override { system_.preconditioner_.finishColumns(); }
    void answers(int pull, std::span<double> out) const override;
    void weigh(std::span<double> sums) override;

private:
    void read(const linalg::NodeArray& from, std::span<Vec3> out) const;
    void add(std::span<const Vec3> impulses, linalg::NodeArray& to) const;
    double product(const linalg::NodeArray& a, const linalg::NodeArray& b);

    MatrixFreeSystem& system_;
    WorkerPool* pool_ = nullptr;
    double mass_ = 0.0;
    std::vector<int> slots_;                ///< per grip
    std::vector<Mat3> inverse_;             ///< D^-1 there, scaled
    std::vector<linalg::ColumnEntry> pull_; ///< scratch
    linalg::NodeArray z_, p_, q_;
};

} // namespace filasofia::engine
