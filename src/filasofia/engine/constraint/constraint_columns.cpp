#include "filasofia/engine/constraint/constraint_columns.h"

#include <algorithm>

namespace filasofia::engine {

/// Numbers the blocks of unknowns that contact points act on, or that D couples with others, body by body, and collects
/// their blocks of D and of J.
void ConstraintColumns::numberUnknowns(std::span<const CoupledBody> bodies, std::span<const int> first)
{
    places_.clear();
    d_.clear();
    ofPoints_.clear();
    firstOfPoint_.assign(1, 0);
    int unknowns = 0;
    std::vector<int> blocks;
    std::vector<BlockPlace> coupled;
    const auto number = [&](int block) {
        if (static_cast<std::size_t>(block) >= unknownOf_.size())
            unknownOf_.resize(static_cast<std::size_t>(block) + 1, -1);
        int& unknown = unknownOf_[static_cast<std::size_t>(block)];
        if (unknown < 0) {
            unknown = unknowns++;
            blocks.push_back(block);
        }
        return unknown;
    };
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const BodySmoother& smoother = *bodies[b].smoother;
        blocks.clear();
        for (int point = 0; point < first[b + 1] - first[b]; ++point) {
            scratch_.clear();
            smoother.addColumns(point, scratch_);
            for (const auto& [block, j] : scratch_) ofPoints_.push_back({number(block), j});
            firstOfPoint_.push_back(ofPoints_.size());
        }
        coupled.clear();
        if (!blocks.empty()) smoother.addPlaces(coupled);
        for (const auto& [row, column] : coupled) {
            const int i = number(row), k = number(column);
            const bool lower = i > k;
            places_.push_back({std::max(i, k), std::min(i, k)});
            d_.push_back(lower ? smoother.block(row, column) : smoother.block(column, row));
        }
        for (int block : blocks) {
            const int unknown = number(block);
            places_.push_back({unknown, unknown});
            d_.push_back(smoother.block(block, block));
            unknownOf_[static_cast<std::size_t>(block)] = -1;
        }
    }
    unknowns_ = static_cast<std::size_t>(unknowns);
}

void ConstraintColumns::collect(std::span<const CoupledBody> bodies, std::span<const int> first,
                                const ConstraintRows& rows)
{
    numberUnknowns(bodies, first);
    firstColumn_.assign(1, 0);
    columns_.clear();
    for (const ConstraintRow& row : rows.list) {
        const Mat3 frame = asMatrix(row.constraint->frame);
        for (const WeightedPoint& each : rows.pointsOf(row)) {
            const auto point = static_cast<std::size_t>(each.point);
            for (std::size_t k = firstOfPoint_[point]; k < firstOfPoint_[point + 1]; ++k) {
                const auto from = columns_.begin() + static_cast<std::ptrdiff_t>(firstColumn_.back());
                auto column = std::find_if(from, columns_.end(),
                                           [&](const Column& other) { return other.unknown == ofPoints_[k].unknown; });
                if (column == columns_.end()) column = columns_.insert(column, {ofPoints_[k].unknown, {}});
                column->j += each.weight * (frame * ofPoints_[k].j);
            }
        }
        firstColumn_.push_back(columns_.size());
    }
}

} // namespace filasofia::engine
