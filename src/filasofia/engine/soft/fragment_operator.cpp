#include "filasofia/engine/soft/fragment_operator.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::engine {

FragmentOperator::FragmentOperator(FragmentMatrix matrix, std::span<const Vec3> rightHandSide,
                                   std::span<const Vec3> guess)
    : DenseOperator(rightHandSide.size()), matrix_(std::move(matrix.entries)), mass_(matrix.mass),
      rightHandSide_(rightHandSide.begin(), rightHandSide.end()), guess_(guess.begin(), guess.end())
{
    usable_ = std::ranges::all_of(matrix_, [](double each) { return std::isfinite(each); }) &&
              factor_.factorise(matrix_, static_cast<int>(3 * nodes()));
}

void FragmentOperator::applyInverse(Vector& vector) const
{
    std::vector<double> numbers;
    for (const Vec3& each : vector) numbers.insert(numbers.end(), {each.x, each.y, each.z});
    factor_.solve(numbers);
    for (std::size_t i = 0; i < vector.size(); ++i)
        vector[i] = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
}

double FragmentOperator::begin(std::span<const ContactPoint> points)
{
    points_.clear();
    compliances_.clear();
    for (const ContactPoint& each : points) {
        points_.push_back(each.node);
        Mat3& block = compliances_.emplace_back();
        for (int k = 0; k < 3; ++k) {
            std::ranges::fill(w_, Vec3{});
            w_[static_cast<std::size_t>(each.node)][k] = 1.0;
            applyInverse(w_);
            for (int i = 0; i < 3; ++i) block[i][k] = w_[static_cast<std::size_t>(each.node)][i];
        }
    }
    std::ranges::fill(x_, Vec3{});
    r_ = rightHandSide_;
    p_ = guess_;
    return mass_;
}

void FragmentOperator::read(SolveVector from, std::span<Vec3> out) const
{
    const Vector& vector = vectorOf(from);
    for (std::size_t k = 0; k < points_.size(); ++k) out[k] = vector[static_cast<std::size_t>(points_[k])];
}

void FragmentOperator::add(std::span<const Vec3> impulses, SolveVector to)
{
    if (to != SolveVector::Residual) return; // D = A here, so B = 0
    for (std::size_t k = 0; k < points_.size(); ++k) r_[static_cast<std::size_t>(points_[k])] += impulses[k];
}

double FragmentOperator::multiply()
{
    for (std::size_t i = 0; i < nodes(); ++i) {
        q_[i] = {};
        for (std::size_t k = 0; k < nodes(); ++k) q_[i] += block(static_cast<int>(i), static_cast<int>(k)) * p_[k];
    }
    return product(p_, q_);
}

void FragmentOperator::addColumns(int point, std::vector<BlockColumns>& out) const
{
    out.push_back({points_[static_cast<std::size_t>(point)], Mat3::identity()});
}

Mat3 FragmentOperator::block(int row, int column) const
{
    Mat3 out;
    const std::size_t n = 3 * nodes();
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k)
            out[i][k] = matrix_[static_cast<std::size_t>(3 * row + i) * n + static_cast<std::size_t>(3 * column + k)];
    return out;
}

void FragmentOperator::addPlaces(std::vector<BlockPlace>& out) const
{
    const int count = static_cast<int>(nodes());
    for (int row = 0; row < count; ++row)
        for (int column = 0; column < row; ++column) out.push_back({row, column});
}

void FragmentOperator::smooth()
{
    w_ = r_;
    applyInverse(w_);
}

double FragmentOperator::applyCoarse(std::span<const double>)
{
    z_ = w_;
    return product(r_, z_);
}

void FragmentOperator::subtractSmoothed(std::span<const Vec3> impulses)
{
    std::ranges::fill(w_, Vec3{}); // w_ is free for use: this step has read it for the last time
    for (std::size_t k = 0; k < points_.size(); ++k) w_[static_cast<std::size_t>(points_[k])] += impulses[k];
    applyInverse(w_);
    for (std::size_t i = 0; i < z_.size(); ++i) z_[i] -= w_[i];
}

} // namespace filasofia::engine
