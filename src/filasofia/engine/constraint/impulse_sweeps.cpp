#include "filasofia/engine/constraint/impulse_sweeps.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

// A contact's normal and tangential impulses follow each other this many times per sweep. With once, ten of 1,200 steps
// of falling boxes are not solved, in place of four.
constexpr int kInner = 3;

/// How far an impulse is from the law without its bounds, as a velocity [m/s]. `then` is the impulse at velocity u.
Vec3 errorOf(const ConstraintLaw& law, Vec3 stiffness, const Mat3& compliance, Vec3 u, Vec3 then, Vec3 impulse)
{
    const Vec3 yields = impulse - law.impulse;
    return law.bias + u + compliance * (impulse - then) +
           Vec3{yields.x / stiffness.x, yields.y / stiffness.y, yields.z / stiffness.z};
}

} // namespace

bool ImpulseSweeps::begin(const ConstraintColumns& columns)
{
    columns_ = &columns;
    coupled_.assign(columns.unknowns(), false);
    inverse_.assign(columns.unknowns(), Mat3{});
    changes_.assign(columns.unknowns(), Vec3{});
    rows_.assign(columns.rows(), {});
    responses_.clear();
    for (const auto& [row, column] : columns.places()) {
        if (row == column) continue;
        coupled_[static_cast<std::size_t>(row)] = coupled_[static_cast<std::size_t>(column)] = true;
    }
    for (std::size_t k = 0; k < columns.places().size(); ++k) {
        const auto [row, column] = columns.places()[k];
        if (row == column) inverse_[static_cast<std::size_t>(row)] = inverse(columns.d()[k]);
    }
    if (std::ranges::find(coupled_, true) == coupled_.end()) return true;
    factor_.analyse(columns.places(), static_cast<int>(columns.unknowns()));
    return factor_.factorise(columns.d());
}

Vec3 ImpulseSweeps::velocityOf(std::size_t row) const
{
    Vec3 sum;
    for (const auto& [unknown, j] : columns_->of(row)) sum += j * changes_[static_cast<std::size_t>(unknown)];
    return sum;
}

void ImpulseSweeps::add(std::size_t row, Vec3 impulse)
{
    for (std::size_t k = rows_[row].first; k < rows_[row].first + rows_[row].count; ++k)
        changes_[static_cast<std::size_t>(responses_[k].unknown)] += responses_[k].change * impulse;
}

const Mat3& ImpulseSweeps::complianceOf(std::size_t row)
{
    Row& of = rows_[row];
    if (of.count > 0) return of.compliance;
    const std::span<const ConstraintColumns::Column> columns = columns_->of(row);
    of.first = responses_.size();
    bool anyCoupled = false;
    for (const auto& [unknown, j] : columns) {
        const auto k = static_cast<std::size_t>(unknown);
        anyCoupled = anyCoupled || coupled_[k];
        if (!coupled_[k]) responses_.push_back({unknown, inverse_[k] * transpose(j)});
    }
    if (anyCoupled) respondCoupled(columns);
    of.count = responses_.size() - of.first;
    for (const auto& [unknown, j] : columns)
        for (std::size_t k = of.first; k < responses_.size(); ++k)
            if (responses_[k].unknown == unknown) of.compliance += j * responses_[k].change;
    return of.compliance;
}

void ImpulseSweeps::respondCoupled(std::span<const ConstraintColumns::Column> columns)
{
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<Vec3>& to = solved_[static_cast<std::size_t>(axis)];
        to.assign(changes_.size(), Vec3{});
        for (const auto& [unknown, j] : columns)
            if (coupled_[static_cast<std::size_t>(unknown)]) to[static_cast<std::size_t>(unknown)] = j[axis];
        factor_.solve(to);
    }
    for (std::size_t k = 0; k < changes_.size(); ++k) {
        const Mat3 change = Mat3::columns(solved_[0][k], solved_[1][k], solved_[2][k]);
        if (change != Mat3{}) responses_.push_back({static_cast<int>(k), change});
    }
}

Vec3 ImpulseSweeps::relax(std::size_t row, const ConstraintLaw& law, Vec3 stiffness, Vec3 u, Vec3 impulse)
{
    const Mat3& g = complianceOf(row);
    const auto error = [&](Vec3 at) { return errorOf(law, stiffness, g, u, impulse, at); };
    const double across = g[0][0] + 1.0 / stiffness.x;
    Vec3 to = impulse;
    if (law.kind == ConstraintKind::Weld) {
        const Mat3 yielding = Mat3::diagonal({1.0 / stiffness.x, 1.0 / stiffness.y, 1.0 / stiffness.z});
        return project(law, to - inverse(g + yielding) * error(to)).impulse;
    }
    if (law.bilateral()) return project(law, to - Vec3{error(to).x / across, 0.0, 0.0}).impulse;
    // The largest eigenvalue of the tangential part: with that, a step along the error cannot go too far.
    const double mean = 0.5 * (g[1][1] + g[2][2]), half = 0.5 * (g[1][1] - g[2][2]);
    const double along = mean + std::sqrt(half * half + g[1][2] * g[1][2]) + 1.0 / stiffness.y;
    for (int k = 0; k < kInner; ++k) {
        to.x = std::max(0.0, to.x - error(to).x / across);
        if (to.x >= law.maxImpulse) return {law.maxImpulse, 0.0, 0.0};
        const Vec3 e = error(to);
        to = project(law, {to.x, to.y - e.y / along, to.z - e.z / along}).impulse;
    }
    return to;
}

} // namespace filasofia::engine
