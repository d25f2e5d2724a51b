#include "filasofia/engine/rigid/articulation_operator.h"

#include <algorithm>
#include <utility>

namespace filasofia::engine {
ArticulationOperator::ArticulationOperator(const LinkTree& tree, const ArticulationPlan& plan,
                                           std::vector<Vec3> origins)
    : DenseOperator(plan.joints.free.size()), tree_(tree), plan_(plan), origins_(std::move(origins)),
      rightHandSide_(plan.joints.free.size())
{
    // Without constraints the solve gives the planned change.
    engine::multiply(plan.joints.step.matrix, plan.joints.step.change, rightHandSide_);
}

double ArticulationOperator::begin(std::span<const ContactPoint> points)
{
    points_ = points.size();
    columns_.clear();
    for (const ContactPoint& point : points)
        for (std::size_t f = 0; f < x_.size(); ++f) {
            const int joint = plan_.joints.free[f];
            if (point.joint)
                columns_.push_back(joint == *point.joint ? Vec3{plan_.joints.step.arms[f], 0.0, 0.0} : Vec3{});
            else if (moves(tree_, joint, point.link)) {
                const LinkMotion column = columnAt(tree_, plan_.joints.axes, joint, point.link,
                                                   origins_[static_cast<std::size_t>(point.link)] + point.arm);
                columns_.push_back(point.axis ? Vec3{filasofia::dot(column.angular, *point.axis), 0.0, 0.0}
                                              : column.linear);
            } else
                columns_.push_back({});
        }
    std::ranges::fill(x_, 0.0);
    std::ranges::fill(p_, 0.0);
    r_ = rightHandSide_;
    double largest = 0.0; // the largest effective mass of a joint
    for (std::size_t f = 0; f < plan_.joints.free.size(); ++f)
        largest =
            std::max(largest, plan_.joints.step.matrix(f, f) / (plan_.joints.step.arms[f] * plan_.joints.step.arms[f]));
    return largest;
}

Mat3 ArticulationOperator::between(int one, int two) const
{
    const std::span<const Vec3> i = columnsOf(static_cast<std::size_t>(one)),
                                j = columnsOf(static_cast<std::size_t>(two));
    Mat3 sum;
    for (std::size_t a = 0; a < i.size(); ++a)
        for (std::size_t b = 0; b < j.size(); ++b) sum += plan_.joints.step.inverse(a, b) * outer(i[a], j[b]);
    return sum;
}

void ArticulationOperator::addColumns(int point, std::vector<BlockColumns>& out) const
{
    const std::span<const Vec3> j = columnsOf(static_cast<std::size_t>(point));
    const auto column = [&](std::size_t f) { return f < j.size() ? j[f] : Vec3{}; };
    for (std::size_t f = 0; f < j.size(); f += 3)
        out.push_back({static_cast<int>(f / 3), Mat3::columns(column(f), column(f + 1), column(f + 2))});
}

void ArticulationOperator::addPlaces(std::vector<BlockPlace>& out) const
{
    for (int row = 1; 3 * static_cast<std::size_t>(row) < x_.size(); ++row)
        for (int column = 0; column < row; ++column) out.push_back({row, column});
}

/// The last block is filled up with unknowns of their own, which nothing moves.
Mat3 ArticulationOperator::block(int row, int column) const
{
    Mat3 out;
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) {
            const auto f = static_cast<std::size_t>(3 * row + i), g = static_cast<std::size_t>(3 * column + k);
            out[i][k] = std::max(f, g) < x_.size() ? plan_.joints.step.matrix(f, g) : f == g ? 1.0 : 0.0;
        }
    return out;
}

double ArticulationOperator::multiply()
{
    engine::multiply(plan_.joints.step.matrix, p_, q_);
    return product(p_, q_);
}

void ArticulationOperator::smooth() { engine::multiply(plan_.joints.step.inverse, r_, w_); }

double ArticulationOperator::applyCoarse(std::span<const double>)
{
    z_ = w_;
    return product(r_, z_);
}

void ArticulationOperator::subtractSmoothed(std::span<const Vec3> impulses)
{
    Vector pushed(x_.size()), moved(x_.size());
    addTo(pushed, impulses);
    engine::multiply(plan_.joints.step.inverse, pushed, moved);
    for (std::size_t i = 0; i < z_.size(); ++i) z_[i] -= moved[i];
}

void ArticulationOperator::read(SolveVector from, std::span<Vec3> out) const
{
    const Vector& vector = vectorOf(from);
    for (std::size_t k = 0; k < points_; ++k) {
        const std::span<const Vec3> j = columnsOf(k);
        out[k] = {};
        for (std::size_t f = 0; f < j.size(); ++f) out[k] += vector[f] * j[f];
    }
}

void ArticulationOperator::add(std::span<const Vec3> impulses, SolveVector to)
{
    if (to == SolveVector::Residual) addTo(r_, impulses); // D = A here, so B = 0
}

void ArticulationOperator::addTo(Vector& to, std::span<const Vec3> impulses) const
{
    for (std::size_t k = 0; k < points_; ++k) {
        const std::span<const Vec3> j = columnsOf(k);
        for (std::size_t f = 0; f < j.size(); ++f) to[f] += filasofia::dot(j[f], impulses[k]);
    }
}

} // namespace filasofia::engine
