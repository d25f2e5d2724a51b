#include "filasofia/engine/constraint/block_operator.h"

#include <algorithm>

namespace filasofia::engine {
BlockOperator::BlockOperator(const BlockOperatorInput& in)
    : DenseOperator(in.diagonal.size()), in_(in), s_(in.diagonal.size())
{
    for (const Mat3& block : in.diagonal) inverse_.push_back(inverse(block));
}

double BlockOperator::begin(std::span<const ContactPoint> points)
{
    points_.assign(points.begin(), points.end());
    std::fill(x_.begin(), x_.end(), Vec3{});
    std::ranges::copy(in_.rightHandSide, r_.begin());
    std::fill(p_.begin(), p_.end(), Vec3{});
    std::ranges::copy(in_.guess, p_.begin());
    return in_.mass;
}

Mat3 BlockOperator::compliance(int point) const
{
    const ContactPoint& at = points_[static_cast<std::size_t>(point)];
    const std::size_t i = unknownOf(at);
    if (!in_.turning) return inverse_[i];
    if (at.axis) return {{{filasofia::dot(*at.axis, inverse_[i + 1] * *at.axis), 0.0, 0.0}, {}, {}}};
    const Mat3 arm = crossMatrix(at.arm); // v + omega x r, and the torque r x F
    return inverse_[i] + arm * inverse_[i + 1] * transpose(arm);
}

void BlockOperator::addColumns(int point, std::vector<BlockColumns>& out) const
{
    const ContactPoint& at = points_[static_cast<std::size_t>(point)];
    const int i = static_cast<int>(unknownOf(at));
    if (at.axis) return out.push_back({i + 1, {{*at.axis, {}, {}}}});
    out.push_back({i, Mat3::identity()});
    if (in_.turning) out.push_back({i + 1, transpose(crossMatrix(at.arm))}); // omega x arm
}

double BlockOperator::multiply()
{
    if (in_.matrix)
        in_.matrix->multiply(p_, q_);
    else
        for (std::size_t i = 0; i < p_.size(); ++i) q_[i] = in_.diagonal[i] * p_[i];
    return product(p_, q_);
}

void BlockOperator::smooth()
{
    for (std::size_t i = 0; i < r_.size(); ++i) w_[i] = inverse_[i] * r_[i];
    s_ = r_;
}

double BlockOperator::applyCoarse(std::span<const double>)
{
    std::fill(z_.begin(), z_.end(), Vec3{});
    if (in_.solver) in_.solver->solveAgain(s_, z_);
    for (std::size_t i = 0; i < z_.size(); ++i) z_[i] += w_[i];
    return product(r_, z_);
}

void BlockOperator::subtractSmoothed(std::span<const Vec3> impulses)
{
    std::fill(w_.begin(), w_.end(), Vec3{}); // w_ is free for use: this step has read it for the last time
    addTo(w_, impulses);
    for (std::size_t i = 0; i < w_.size(); ++i) z_[i] -= inverse_[i] * w_[i];
}

void BlockOperator::read(SolveVector from, std::span<Vec3> out) const
{
    const Vector& vector = vectorOf(from);
    for (std::size_t k = 0; k < points_.size(); ++k) {
        const std::size_t i = unknownOf(points_[k]);
        if (points_[k].axis)
            out[k] = {filasofia::dot(vector[i + 1], *points_[k].axis), 0.0, 0.0};
        else
            out[k] = in_.turning ? vector[i] + cross(vector[i + 1], points_[k].arm) : vector[i];
    }
}

void BlockOperator::add(std::span<const Vec3> impulses, SolveVector to)
{
    addTo(to == SolveVector::Residual ? r_ : s_, impulses);
}

void BlockOperator::addTo(Vector& to, std::span<const Vec3> impulses) const
{
    for (std::size_t k = 0; k < points_.size(); ++k) {
        const std::size_t i = unknownOf(points_[k]);
        if (points_[k].axis) {
            to[i + 1] += impulses[k].x * *points_[k].axis;
            continue;
        }
        to[i] += impulses[k];
        if (in_.turning) to[i + 1] += cross(points_[k].arm, impulses[k]);
    }
}

} // namespace filasofia::engine
