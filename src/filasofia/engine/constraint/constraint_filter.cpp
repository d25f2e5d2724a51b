#include "filasofia/engine/constraint/constraint_filter.h"

#include <algorithm>

namespace filasofia::engine {

void ConstraintFilter::begin(std::span<const CoupledBody> bodies, std::span<const int> first,
                             const ConstraintRows& rows)
{
    columns_.collect(bodies, first, rows);
    places_.assign(columns_.places().begin(), columns_.places().end());
    vector_.resize(columns_.unknowns());
    placed_.assign(rows.list.size(), 0);
}

bool ConstraintFilter::build(std::span<const Vec3> sigma)
{
    sigma_.assign(sigma.begin(), sigma.end());
    places_.resize(columns_.places().size());
    k_.assign(columns_.d().begin(), columns_.d().end());
    for (std::size_t r = 0; r < sigma_.size(); ++r) {
        // A contact that pushes no more keeps its places, so that the order is found anew only for one that begins.
        if (sigma_[r] == Vec3{} && placed_[r] == 0) continue;
        placed_[r] = 1;
        for (const ConstraintColumns::Column& one : columns_.of(r)) {
            const Mat3 stiff = transpose(Mat3::diagonal(sigma_[r]) * one.j);
            for (const ConstraintColumns::Column& two : columns_.of(r)) {
                if (one.unknown < two.unknown) continue;
                places_.push_back({one.unknown, two.unknown});
                k_.push_back(stiff * two.j);
            }
        }
    }
    factor_.analyse(places_, static_cast<int>(vector_.size()));
    return factor_.factorise(k_);
}

void ConstraintFilter::apply(std::span<Vec3> perRow)
{
    std::ranges::fill(vector_, Vec3{});
    for (std::size_t r = 0; r < sigma_.size(); ++r) {
        perRow[r] = times(sigma_[r], perRow[r]);
        if (perRow[r] == Vec3{}) continue;
        for (const auto& [unknown, j] : columns_.of(r))
            vector_[static_cast<std::size_t>(unknown)] += transposeTimes(j, perRow[r]);
    }
    factor_.solve(vector_);
    for (std::size_t r = 0; r < sigma_.size(); ++r) {
        if (sigma_[r] == Vec3{}) continue;
        Vec3 yielded;
        for (const auto& [unknown, j] : columns_.of(r)) yielded += j * vector_[static_cast<std::size_t>(unknown)];
        perRow[r] -= times(sigma_[r], yielded);
    }
}

} // namespace filasofia::engine
