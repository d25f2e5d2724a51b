#pragma once

#include "filasofia/engine/constraint/dense_operator.h"
#include "filasofia/engine/soft/fragment_matrix.h"
#include "filasofia/linalg/dense_cholesky.h"

namespace filasofia::engine {

/// The body operator of a small fragment, for coupled solves: D is the whole matrix.
class FragmentOperator final : public DenseOperator<Vec3> {
public:
    /// Per node of the fragment: the right-hand side [N s] and the first guess [m/s].
    FragmentOperator(FragmentMatrix matrix, std::span<const Vec3> rightHandSide, std::span<const Vec3> guess);
    /// Whether the matrix is positive definite to rounding. If not, the operator must not be used.
    [[nodiscard]] bool usable() const { return usable_; }

    double begin(std::span<const ContactPoint> points) override;
    void read(SolveVector from, std::span<Vec3> out) const override;
    void add(std::span<const Vec3> impulses, SolveVector to) override;
    double multiply() override;

    [[nodiscard]] Mat3 compliance(int point) const override { return compliances_[static_cast<std::size_t>(point)]; }
    void addColumns(int point, std::vector<BlockColumns>& out) const override;
    [[nodiscard]] Mat3 block(int row, int column) const override;
    void addPlaces(std::vector<BlockPlace>& out) const override;
    [[nodiscard]] bool isExact() const override { return true; }
    [[nodiscard]] bool couplesNodes() const override { return true; }

    void smooth() override;
    double applyCoarse(std::span<const double> shares) override;
    void subtractSmoothed(std::span<const Vec3> impulses) override;

private:
    [[nodiscard]] std::size_t nodes() const { return x_.size(); }
    void applyInverse(Vector& vector) const;

    std::vector<double> matrix_; ///< [kg] all entries, row by row
    linalg::DenseCholesky factor_;
    bool usable_ = false;
    double mass_;
    Vector rightHandSide_, guess_;
    std::vector<int> points_;       ///< per contact point: its node
    std::vector<Mat3> compliances_; ///< the same: the block of A^-1 on the diagonal
};

} // namespace filasofia::engine
