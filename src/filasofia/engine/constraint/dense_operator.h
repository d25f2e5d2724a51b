#pragma once

#include "filasofia/engine/constraint/body_operator.h"
#include "filasofia/math/vec3.h"

#include <vector>

namespace filasofia::engine {

/// The vectors of a coupled solve in double, one Value (a number or a Vec3) per unknown, and the operations of
/// conjugate gradients that do not depend on the matrix.
template <class Value> class DenseOperator : public BodyOperator, public BodySmoother, public BodyPreconditioner {
public:
    [[nodiscard]] std::span<const Value> answer() const { return x_; }

    double dot(SolveVector a, SolveVector) override
    {
        return a == SolveVector::Direction ? product(p_, r_) : product(z_, q_);
    }
    void step(double alpha) override
    {
        for (std::size_t i = 0; i < x_.size(); ++i) {
            x_[i] += alpha * p_[i];
            r_[i] -= alpha * q_[i];
        }
    }
    void updateDirection(double beta) override
    {
        for (std::size_t i = 0; i < p_.size(); ++i) p_[i] = z_[i] + beta * p_[i];
    }

protected:
    using Vector = std::vector<Value>;
    explicit DenseOperator(std::size_t unknowns)
    {
        for (Vector* vector : {&x_, &r_, &p_, &q_, &w_, &z_}) vector->resize(unknowns);
    }

    /// Sums in the order of the unknowns.
    static double product(const Vector& a, const Vector& b)
    {
        double sum = 0.0;
        for (std::size_t i = 0; i < a.size(); ++i) sum += times(a[i], b[i]);
        return sum;
    }
    [[nodiscard]] const Vector& vectorOf(SolveVector which) const
    {
        return which == SolveVector::Direction ? p_ : which == SolveVector::Smoothed ? w_ : z_;
    }

    Vector x_, r_, p_, q_, w_, z_;

private:
    static double times(double a, double b) { return a * b; }
    static double times(Vec3 a, Vec3 b) { return filasofia::dot(a, b); }
};

} // namespace filasofia::engine
