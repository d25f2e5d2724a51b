#include "filasofia/engine/constraint/exact_filter.h"

#include <algorithm>

namespace filasofia::engine {

void ExactFilter::begin(std::span<const SmallBody* const> bodies, std::span<const int> first,
                        const ConstraintRows& rows)
{
    unknowns_.clear();
    offsets_.assign(1, 0);
    a_.clear();
    std::vector<std::size_t> bodyOf(static_cast<std::size_t>(first.back())); // per contact point
    std::vector<double> matrix;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const std::size_t n = bodies[b]->unknowns(), at = offsets_.back();
        std::fill(bodyOf.begin() + first[b], bodyOf.begin() + first[b + 1], b);
        matrix.assign(n * n, 0.0);
        bodies[b]->writeMatrix(matrix);
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = 0; j <= i; ++j)
                if (i == j || matrix[i * n + j] != 0.0)
                    a_.push_back({static_cast<int>(at + i), static_cast<int>(at + j), matrix[i * n + j]});
        unknowns_.push_back(n);
        offsets_.push_back(at + n);
    }
    vector_.resize(offsets_.back());

    firstSide_.assign(1, 0);
    sides_.clear();
    columns_.clear();
    std::vector<Vec3> ofPoint;
    for (const ConstraintRow& row : rows.list) {
        for (const WeightedPoint& each : rows.pointsOf(row)) {
            const std::size_t b = bodyOf[static_cast<std::size_t>(each.point)], n = unknowns_[b];
            auto side = std::find_if(sides_.begin() + static_cast<std::ptrdiff_t>(firstSide_.back()), sides_.end(),
                                     [&](const Side& other) { return other.body == b; });
            if (side == sides_.end()) {
                side = sides_.insert(side, {b, columns_.size()});
                columns_.resize(columns_.size() + n);
            }
            ofPoint.assign(n, Vec3{});
            bodies[b]->writeColumns(each.point - first[b], ofPoint);
            for (std::size_t k = 0; k < n; ++k)
                columns_[side->columns + k] += each.weight * inFrame(row.constraint->frame, ofPoint[k]);
        }
        firstSide_.push_back(sides_.size());
    }
}

bool ExactFilter::build(std::span<const Vec3> sigma)
{
    sigma_.assign(sigma.begin(), sigma.end());
    k_ = a_;
    const auto add = [&](const Side& one, const Side& two, Vec3 stiffness) {
        const std::span<const Vec3> a = columnsOf(one), b = columnsOf(two);
        for (std::size_t i = 0; i < a.size(); ++i)
            for (std::size_t j = 0; j < b.size(); ++j) {
                const std::size_t row = offsets_[one.body] + i, column = offsets_[two.body] + j;
                if (row >= column)
                    k_.push_back({static_cast<int>(row), static_cast<int>(column), dot(a[i], times(stiffness, b[j]))});
            }
    };
    for (std::size_t r = 0; r < sigma_.size(); ++r) {
        if (sigma_[r] == Vec3{}) continue;
        for (const Side& one : sidesOf(r))
            for (const Side& two : sidesOf(r))
                if (one.body >= two.body) add(one, two, sigma_[r]);
    }
    return factor_.factorise(k_, static_cast<int>(vector_.size()));
}

void ExactFilter::apply(std::span<Vec3> perRow)
{
    std::ranges::fill(vector_, 0.0);
    for (std::size_t r = 0; r < sigma_.size(); ++r) {
        perRow[r] = times(sigma_[r], perRow[r]);
        if (perRow[r] == Vec3{}) continue;
        for (const Side& side : sidesOf(r))
            for (std::size_t k = 0; k < unknowns_[side.body]; ++k)
                vector_[offsets_[side.body] + k] += dot(columnsOf(side)[k], perRow[r]);
    }
    factor_.solve(vector_);
    for (std::size_t r = 0; r < sigma_.size(); ++r) {
        if (sigma_[r] == Vec3{}) continue;
        Vec3 yielded;
        for (const Side& side : sidesOf(r))
            for (std::size_t k = 0; k < unknowns_[side.body]; ++k)
                yielded += vector_[offsets_[side.body] + k] * columnsOf(side)[k];
        perRow[r] -= times(sigma_[r], yielded);
    }
}

} // namespace filasofia::engine
