#include "filasofia/engine/soft/rod_operator.h"

#include <algorithm>

namespace filasofia::engine {

RodOperator::RodOperator(const RodSystem& system, std::span<const Vec3> guess, double mass)
    : DenseOperator(system.matrix().rows()), system_(system), guess_(guess), mass_(mass)
{
    system.factor().invert(inverse_);
}

double RodOperator::begin(std::span<const ContactPoint> points)
{
    places_.clear();
    for (const ContactPoint& each : points) {
        const std::size_t first = 4 * static_cast<std::size_t>(each.node);
        places_.push_back(each.perSpin ? Place{first + 3, each.perSpin} : Place{first});
    }
    std::ranges::fill(x_, 0.0);
    std::ranges::copy(system_.rightHandSide(), r_.begin());
    std::ranges::fill(p_, 0.0);
    for (std::size_t i = 0; i < guess_.size(); ++i)
        for (int k = 0; k < 3; ++k) p_[4 * i + static_cast<std::size_t>(k)] = guess_[i][k];
    return mass_;
}

std::size_t RodOperator::unknownOf(std::size_t block, std::size_t row) const
{
    if (block < nodes()) return 4 * block + row;
    const std::size_t edge = 3 * (block - nodes()) + row;
    return edge < nodes() ? 4 * edge + 3 : x_.size();
}

Mat3 RodOperator::block(int row, int column) const
{
    Mat3 out;
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) {
            const std::size_t u = unknownOf(static_cast<std::size_t>(row), static_cast<std::size_t>(i));
            const std::size_t v = unknownOf(static_cast<std::size_t>(column), static_cast<std::size_t>(k));
            if (std::max(u, v) < x_.size()) out[i][k] = system_.matrix().entry(u, v);
        }
    // The last block is filled up with unknowns of their own, which nothing moves.
    for (int i = 1; row == column && i < 3; ++i)
        if (out[i][i] == 0.0) out[i][i] = out[0].x;
    return out;
}

void RodOperator::addPlaces(std::vector<BlockPlace>& out) const
{
    const int count = static_cast<int>(nodes());
    for (int i = 1; i < count; ++i) out.push_back({i, i - 1});
    for (int i = 2; i < count; ++i) out.push_back({i, i - 2});
    for (int m = 0; 3 * m < count; ++m) {
        // The edges 3 m to 3 m + 2 are coupled with the nodes from 3 m - 1 to 3 m + 4, and with the edges beside them.
        const int first = std::max(0, 3 * m - 1), last = std::min(count - 1, 3 * m + 4);
        for (int i = first; i <= last; ++i) out.push_back({count + m, i});
        if (m > 0) out.push_back({count + m, count + m - 1});
    }
    if (!system_.matrix().cyclic()) return;
    const int blocks = (count + 2) / 3, before = count + (count - 2) / 3; // the block of the last edge but one
    out.push_back({count - 1, 0});
    out.push_back({count - 1, 1});
    out.push_back({count - 2, 0});
    out.push_back({count, count - 1});
    out.push_back({count + blocks - 1, 0});
    out.push_back({count + blocks - 1, 1});
    out.push_back({count + blocks - 1, count});
    if (before != count + blocks - 1) out.push_back({before, 0});
}

Mat3 RodOperator::compliance(int point) const
{
    const auto& [first, perSpin] = places_[static_cast<std::size_t>(point)];
    if (perSpin) return inverse_.entry(first, first) * outer(*perSpin, *perSpin);
    Mat3 out;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k)
            out[static_cast<int>(i)][static_cast<int>(k)] = inverse_.entry(first + i, first + k);
    return out;
}

void RodOperator::addColumns(int point, std::vector<BlockColumns>& out) const
{
    const auto& [first, perSpin] = places_[static_cast<std::size_t>(point)];
    const std::size_t i = first / 4;
    if (!perSpin) return out.push_back({static_cast<int>(i), Mat3::identity()});
    Mat3 turning;
    for (int axis = 0; axis < 3; ++axis) turning[axis][static_cast<int>(i % 3)] = (*perSpin)[axis];
    out.push_back({static_cast<int>(nodes() + i / 3), turning});
}

double RodOperator::multiply()
{
    system_.matrix().multiply(p_, q_);
    return product(p_, q_);
}

void RodOperator::smooth()
{
    w_ = r_;
    system_.factor().solve(w_);
}

double RodOperator::applyCoarse(std::span<const double>)
{
    z_ = w_;
    return product(r_, z_);
}

void RodOperator::subtractSmoothed(std::span<const Vec3> impulses)
{
    std::ranges::fill(w_, 0.0); // w_ is free for use: this step has read it for the last time
    addTo(w_, impulses);
    system_.factor().solve(w_);
    for (std::size_t i = 0; i < z_.size(); ++i) z_[i] -= w_[i];
}

void RodOperator::read(SolveVector from, std::span<Vec3> out) const
{
    const Vector& vector = vectorOf(from);
    for (std::size_t k = 0; k < places_.size(); ++k) {
        const auto& [first, perSpin] = places_[k];
        out[k] = perSpin ? vector[first] * *perSpin : Vec3{vector[first], vector[first + 1], vector[first + 2]};
    }
}

void RodOperator::add(std::span<const Vec3> impulses, SolveVector to)
{
    if (to == SolveVector::Residual) addTo(r_, impulses); // D = A here, so B = 0
}

void RodOperator::addTo(Vector& to, std::span<const Vec3> impulses) const
{
    for (std::size_t k = 0; k < places_.size(); ++k) {
        const auto& [first, perSpin] = places_[k];
        if (perSpin)
            to[first] += filasofia::dot(*perSpin, impulses[k]);
        else
            for (int i = 0; i < 3; ++i) to[first + static_cast<std::size_t>(i)] += impulses[k][i];
    }
}

} // namespace filasofia::engine
