#include "filasofia/linalg/linear_solver.h"

#include <algorithm>
#include <vector>

namespace filasofia::linalg {
namespace {

double dotProduct(std::span<const Vec3> a, std::span<const Vec3> b)
{
    double sum = 0.0; // in index order: the same bits on every machine
    for (std::size_t i = 0; i < a.size(); ++i) sum += dot(a[i], b[i]);
    return sum;
}

class ConjugateGradient final : public LinearSolver {
public:
    ConjugateGradient(int maxIterations, double tolerance) : maxIterations_(maxIterations), tolerance_(tolerance) {}

    SolveReport solve(const LinearOperator& a, std::span<const Vec3> b, std::span<Vec3> x) override
    {
        prepare(a);
        const double size = dotProduct(b, b);
        if (size == 0.0 || !std::isfinite(size)) { // a tolerance relative to zero accepts no guess
            std::fill(x.begin(), x.end(), Vec3{});
            return {.residual = size == 0.0 ? 0.0 : 1.0, .converged = size == 0.0};
        }
        const double target = tolerance_ * tolerance_ * size;
        a.multiply(x, q_);
        for (std::size_t i = 0; i < b.size(); ++i) r_[i] = b[i] - q_[i];

        int iteration = 0;
        double residual = dotProduct(r_, r_), rz = 0.0;
        for (; residual > target && iteration < maxIterations_; ++iteration) {
            for (std::size_t i = 0; i < z_.size(); ++i) z_[i] = inverseDiagonal_[i] * r_[i];
            const double rzNew = dotProduct(r_, z_);
            const double beta = iteration == 0 ? 0.0 : rzNew / rz;
            rz = rzNew;
            for (std::size_t i = 0; i < p_.size(); ++i) p_[i] = z_[i] + beta * p_[i];
            a.multiply(p_, q_);
            const double curvature = dotProduct(p_, q_);
            if (!(curvature > 0.0)) break; // not positive definite, or not finite: this is the best answer
            const double alpha = rz / curvature;
            for (std::size_t i = 0; i < x.size(); ++i) {
                x[i] += alpha * p_[i];
                r_[i] -= alpha * q_[i];
            }
            residual = dotProduct(r_, r_);
        }
        return {iteration, std::sqrt(residual / size), residual <= target};
    }

private:
    void prepare(const LinearOperator& a)
    {
        const auto n = static_cast<std::size_t>(a.rows());
        for (auto* buffer : {&r_, &z_, &p_, &q_}) buffer->resize(n);
        p_.assign(n, {});
        inverseDiagonal_.resize(n);
        a.diagonal(inverseDiagonal_);
        for (Mat3& block : inverseDiagonal_) block = inverse(block);
    }

    int maxIterations_;
    double tolerance_;
    std::vector<Vec3> r_, z_, p_, q_; ///< residual, preconditioned residual, direction, A times direction
    std::vector<Mat3> inverseDiagonal_;
};

} // namespace

std::unique_ptr<LinearSolver> makeConjugateGradient(int maxIterations, double tolerance)
{
    return std::make_unique<ConjugateGradient>(maxIterations, tolerance);
}

} // namespace filasofia::linalg
