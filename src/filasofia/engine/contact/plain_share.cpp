#include "filasofia/engine/contact/plain_share.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

double product(const std::vector<Vec3>& a, const std::vector<Vec3>& b)
{
    double sum = 0.0; // in the order of the unknowns
    for (std::size_t i = 0; i < a.size(); ++i) sum += dot(a[i], b[i]);
    return sum;
}

} // namespace

PlainShare::PlainShare(const PlainShareInput& in) : in_(in)
{
    for (const Mat3& block : in.diagonal) inverse_.push_back(inverse(block));
    for (auto* vector : {&x_, &r_, &p_, &q_, &w_, &s_, &z_, &xSaved_, &rSaved_}) vector->resize(inverse_.size());
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

double PlainShare::slope() { return product(p_, r_); }

void PlainShare::descend(double alpha)
{
    for (std::size_t i = 0; i < x_.size(); ++i) {
        x_[i] += alpha * p_[i];
        r_[i] -= alpha * q_[i];
    }
}

void PlainShare::turn(double beta)
{
    for (std::size_t i = 0; i < p_.size(); ++i) p_[i] = z_[i] + beta * p_[i];
}

void PlainShare::smooth()
{
    for (std::size_t i = 0; i < r_.size(); ++i) w_[i] = inverse_[i] * r_[i];
    s_ = r_;
}

double PlainShare::spread()
{
    std::fill(z_.begin(), z_.end(), Vec3{});
    if (in_.solver) in_.solver->solveAgain(s_, z_);
    for (std::size_t i = 0; i < z_.size(); ++i) z_[i] += w_[i];
    return product(r_, z_);
}

void PlainShare::save()
{
    xSaved_ = x_;
    rSaved_ = r_;
}

std::array<double, 2> PlainShare::rise()
{
    std::array<double, 2> sums{};
    for (std::size_t i = 0; i < x_.size(); ++i) {
        sums[0] += dot(x_[i] - xSaved_[i], rSaved_[i]);
        sums[1] += dot(x_[i] - xSaved_[i], r_[i]);
    }
    return sums;
}

void PlainShare::goBack(double t)
{
    for (std::size_t i = 0; i < x_.size(); ++i) {
        x_[i] = xSaved_[i] + t * (x_[i] - xSaved_[i]);
        r_[i] = rSaved_[i] + t * (r_[i] - rSaved_[i]);
    }
}

void PlainShare::addToSpread(std::span<const Vec3> impulses) { add(impulses, s_); }

void PlainShare::subtractSmoothed(std::span<const Vec3> impulses)
{
    std::fill(w_.begin(), w_.end(), Vec3{}); // read for the last time already
    add(impulses, w_);
    for (std::size_t i = 0; i < w_.size(); ++i) z_[i] -= inverse_[i] * w_[i];
}

void PlainShare::read(const std::vector<Vec3>& from, std::span<Vec3> out) const
{
    for (std::size_t g = 0; g < grips_.size(); ++g) {
        const std::size_t i = unknownOf(grips_[g]);
        out[g] = in_.turning ? from[i] + cross(from[i + 1], grips_[g].arm) : from[i];
    }
}

void PlainShare::add(std::span<const Vec3> impulses, std::vector<Vec3>& to) const
{
    for (std::size_t g = 0; g < grips_.size(); ++g) {
        const std::size_t i = unknownOf(grips_[g]);
        to[i] += impulses[g];
        if (in_.turning) to[i + 1] += cross(grips_[g].arm, impulses[g]);
    }
}

} // namespace filasofia::engine
