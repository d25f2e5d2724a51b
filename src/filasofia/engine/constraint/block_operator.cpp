#include "filasofia/engine/constraint/block_operator.h"

#include <algorithm>

namespace filasofia::engine {
PlainShare::PlainShare(const PlainShareInput& in) : DenseShare(in.diagonal.size()), in_(in), s_(in.diagonal.size())
{
    for (const Mat3& block : in.diagonal) inverse_.push_back(inverse(block));
}

void PlainShare::begin(std::span<const Grip> grips)
{
    grips_.assign(grips.begin(), grips.end());
    std::fill(x_.begin(), x_.end(), Vec3{});
    std::ranges::copy(in_.rightHandSide, r_.begin());
    std::fill(p_.begin(), p_.end(), Vec3{});
    std::ranges::copy(in_.guess, p_.begin());
}

Mat3 PlainShare::compliance(int grip) const
{
    const Grip& at = grips_[static_cast<std::size_t>(grip)];
    const std::size_t i = unknownOf(at);
    if (!in_.turning) return inverse_[i];
    const Mat3 arm = crossMatrix(at.arm); // v + omega x r, and the torque r x F
    return inverse_[i] + arm * inverse_[i + 1] * transpose(arm);
}

double PlainShare::multiply()
{
    if (in_.matrix)
        in_.matrix->multiply(p_, q_);
    else
        for (std::size_t i = 0; i < p_.size(); ++i) q_[i] = in_.diagonal[i] * p_[i];
    return product(p_, q_);
}

void PlainShare::smooth()
{
    for (std::size_t i = 0; i < r_.size(); ++i) w_[i] = inverse_[i] * r_[i];
    s_ = r_;
}

double PlainShare::spread(std::span<const double>)
{
    std::fill(z_.begin(), z_.end(), Vec3{});
    if (in_.solver) in_.solver->solveAgain(s_, z_);
    for (std::size_t i = 0; i < z_.size(); ++i) z_[i] += w_[i];
    return product(r_, z_);
}

void PlainShare::addToSpread(std::span<const Vec3> impulses) { add(impulses, s_); }

void PlainShare::subtractSmoothed(std::span<const Vec3> impulses)
{
    std::fill(w_.begin(), w_.end(), Vec3{}); // read for the last time already
    add(impulses, w_);
    for (std::size_t i = 0; i < w_.size(); ++i) z_[i] -= inverse_[i] * w_[i];
}

void PlainShare::read(const Vector& from, std::span<Vec3> out) const
{
    for (std::size_t g = 0; g < grips_.size(); ++g) {
        const std::size_t i = unknownOf(grips_[g]);
        out[g] = in_.turning ? from[i] + cross(from[i + 1], grips_[g].arm) : from[i];
    }
}

void PlainShare::add(std::span<const Vec3> impulses, Vector& to) const
{
    for (std::size_t g = 0; g < grips_.size(); ++g) {
        const std::size_t i = unknownOf(grips_[g]);
        to[i] += impulses[g];
        if (in_.turning) to[i + 1] += cross(grips_[g].arm, impulses[g]);
    }
}

} // namespace filasofia::engine
