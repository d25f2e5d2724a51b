#include "filasofia/engine/rigid/articulation_operator.h"

#include <algorithm>
#include <utility>

namespace filasofia::engine {
ArticulatedShare::ArticulatedShare(const LinkTree& tree, const ArticulationPlan& plan, std::vector<Vec3> origins)
    : DenseShare(plan.free.size()), tree_(tree), plan_(plan), origins_(std::move(origins)),
      rightHandSide_(plan.free.size())
{
    engine::multiply(plan.matrix, plan.change, rightHandSide_); // so that without constraints it does what it would
}

void ArticulatedShare::begin(std::span<const Grip> grips)
{
    grips_ = grips.size();
    columns_.clear();
    for (const Grip& grip : grips)
        for (std::size_t f = 0; f < x_.size(); ++f) {
            const int joint = plan_.free[f];
            if (grip.link < 0)
                columns_.push_back(joint == -1 - grip.link ? Vec3{plan_.arms[f], 0.0, 0.0} : Vec3{});
            else if (moves(tree_, joint, grip.link))
                columns_.push_back(
                    columnAt(tree_, plan_.axes, joint, origins_[static_cast<std::size_t>(grip.link)] + grip.arm)
                        .linear);
            else
                columns_.push_back({});
        }
    std::ranges::fill(x_, 0.0);
    std::ranges::fill(p_, 0.0);
    r_ = rightHandSide_;
}

Mat3 ArticulatedShare::compliance(int grip) const
{
    const std::span<const Vec3> j = columnsOf(static_cast<std::size_t>(grip));
    Mat3 sum;
    for (std::size_t a = 0; a < j.size(); ++a)
        for (std::size_t b = 0; b < j.size(); ++b) sum += plan_.inverse(a, b) * outer(j[a], j[b]);
    return sum;
}

double ArticulatedShare::mass() const
{
    double most = 0.0; // the largest mass that one of them moves
    for (std::size_t f = 0; f < plan_.free.size(); ++f)
        most = std::max(most, plan_.matrix(f, f) / (plan_.arms[f] * plan_.arms[f]));
    return most;
}

double ArticulatedShare::multiply()
{
    engine::multiply(plan_.matrix, p_, q_);
    return product(p_, q_);
}

void ArticulatedShare::smooth() { engine::multiply(plan_.inverse, r_, w_); }

double ArticulatedShare::spread(std::span<const double>)
{
    z_ = w_;
    return product(r_, z_);
}

void ArticulatedShare::subtractSmoothed(std::span<const Vec3> impulses)
{
    Vector pushed(x_.size()), moved(x_.size());
    add(impulses, pushed);
    engine::multiply(plan_.inverse, pushed, moved);
    for (std::size_t i = 0; i < z_.size(); ++i) z_[i] -= moved[i];
}

void ArticulatedShare::read(const Vector& from, std::span<Vec3> out) const
{
    for (std::size_t g = 0; g < grips_; ++g) {
        const std::span<const Vec3> j = columnsOf(g);
        out[g] = {};
        for (std::size_t f = 0; f < j.size(); ++f) out[g] += from[f] * j[f];
    }
}

void ArticulatedShare::add(std::span<const Vec3> impulses, Vector& to) const
{
    for (std::size_t g = 0; g < grips_; ++g) {
        const std::span<const Vec3> j = columnsOf(g);
        for (std::size_t f = 0; f < j.size(); ++f) to[f] += dot(j[f], impulses[g]);
    }
}

} // namespace filasofia::engine
