#include "filasofia/engine/constraint/patch_correction.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

constexpr std::size_t kMaxPatches = 32; // the patches with the most constraints; S is dense

struct Patch {
    std::size_t from = 0, to = 0; ///< bodies
    bool bilateral = false;
    std::array<int, 2> pieces = {};   ///< in the order of the constraint's sides, not of `from` and `to`
    std::vector<std::size_t> members; ///< rows
};

/// A rigid motion of one side of a patch relative to the other.
struct Motion {
    const Patch* patch = nullptr;
    std::vector<Vec3> u;       ///< [m/s] per member, in its frame
    std::vector<Vec3> impulse; ///< [N s] M u
};

Vec3 rowPosition(const ConstraintRow& row) { return row.constraint->sides[0].position; }

std::size_t bodyOf(std::span<const int> first, int point)
{
    return static_cast<std::size_t>(std::ranges::upper_bound(first, point) - first.begin()) - 1;
}

DeflationOperator* deflationOf(const CoupledBody& body) { return body.preconditioner->deflation(); }

std::vector<Patch> findPatches(std::span<const CoupledBody> bodies, std::span<const int> first,
                               const ConstraintRows& rows, std::span<const Mat3> filters)
{
    std::vector<Patch> patches;
    for (std::size_t c = 0; c < filters.size(); ++c) {
        const ConstraintRow& row = rows.list[c];
        if (filters[c][0].x == 0.0) continue;
        const std::span<const WeightedPoint> points = rows.pointsOf(row);
        if (points.empty()) continue; // between points that cannot move
        const std::size_t from = bodyOf(first, points.front().point), to = bodyOf(first, points.back().point);
        if (!deflationOf(bodies[from]) && !deflationOf(bodies[to])) continue;
        const bool bilateral = row.constraint->bilateral();
        const auto same = [&](const Patch& p) {
            return p.from == from && p.to == to && p.bilateral == bilateral && p.pieces == row.pieces;
        };
        auto found = std::ranges::find_if(patches, same);
        if (found == patches.end()) found = patches.insert(found, {from, to, bilateral, row.pieces, {}});
        found->members.push_back(c);
    }
    std::ranges::stable_sort(patches, std::ranges::greater{}, [](const Patch& p) { return p.members.size(); });
    if (patches.size() > kMaxPatches) patches.resize(kMaxPatches);
    return patches;
}

/// Adds three translations and three rotations about the middle, except motions that no constraint resists.
void addMotions(const Patch& patch, const ConstraintRows& rows, std::span<const Mat3> filters,
                std::vector<Motion>& motions)
{
    Vec3 middle;
    double radius = 0.0;
    for (std::size_t c : patch.members)
        middle += 1.0 / static_cast<double>(patch.members.size()) * rowPosition(rows.list[c]);
    for (std::size_t c : patch.members) radius = std::max(radius, length(rowPosition(rows.list[c]) - middle));
    for (int k = 0; k < (radius > 0.0 ? 6 : 3); ++k) {
        Motion motion;
        motion.patch = &patch;
        Vec3 axis;
        axis[k % 3] = 1.0;
        double resisted = 0.0;
        for (std::size_t c : patch.members) {
            const Vec3 u = k < 3 ? axis : 1.0 / radius * cross(axis, rowPosition(rows.list[c]) - middle);
            motion.u.push_back(inFrame(rows.list[c].constraint->frame, u));
            motion.impulse.push_back(filters[c] * motion.u.back());
            resisted += dot(motion.u.back(), motion.impulse.back());
        }
        if (resisted > 0.0) motions.push_back(std::move(motion));
    }
}

/// J^T M u: the motion's impulses at all contact points; `column` has an entry for each.
void columnOf(const Motion& motion, const ConstraintRows& rows, std::vector<Vec3>& column)
{
    std::ranges::fill(column, Vec3{});
    for (std::size_t m = 0; m < motion.impulse.size(); ++m)
        addImpulse(rows, motion.patch->members[m], motion.impulse[m], column);
}

} // namespace

void PatchCorrection::clear()
{
    rows_.clear();
    shares_.clear();
    sums_.clear();
}

std::span<const double> PatchCorrection::shares(std::size_t body) const
{
    return empty() ? std::span<const double>() : shares_[body];
}

void PatchCorrection::make(std::span<const CoupledBody> bodies, std::span<const int> first, const ConstraintRows& rows,
                           std::span<const Mat3> filters)
{
    clear();
    for (const CoupledBody& body : bodies)
        if (DeflationOperator* deflation = deflationOf(body)) deflation->clear();
    const std::vector<Patch> patches = findPatches(bodies, first, rows, filters);
    std::vector<Motion> motions;
    for (const Patch& patch : patches) addMotions(patch, rows, filters, motions);
    const std::size_t size = motions.size();
    std::vector<double> matrix(size * size); // S, its lower half
    rows_.resize(bodies.size());
    shares_.resize(bodies.size());

    std::vector<Vec3> column(static_cast<std::size_t>(first.back()));
    for (std::size_t i = 0; i < size; ++i) {
        const Patch& patch = *motions[i].patch;
        for (std::size_t j = 0; j <= i; ++j)
            for (std::size_t m = 0; m < patch.members.size() && motions[j].patch == &patch; ++m)
                matrix[i * size + j] += dot(motions[i].u[m], motions[j].impulse[m]);
        columnOf(motions[i], rows, column);
        const auto addTo = [&](std::size_t b) {
            DeflationOperator* deflation = deflationOf(bodies[b]);
            if (!deflation) return;
            deflation->addColumn(std::span(column).subspan(static_cast<std::size_t>(first[b]),
                                                           static_cast<std::size_t>(first[b + 1] - first[b])));
            rows_[b].push_back(i);
        };
        addTo(patch.from);
        if (patch.to != patch.from) addTo(patch.to);
    }
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        shares_[b].resize(rows_[b].size());
        if (rows_[b].empty()) continue;
        deflationOf(bodies[b])->finish();
        for (std::size_t i = 0; i < rows_[b].size(); ++i) {
            deflationOf(bodies[b])->products(static_cast<int>(i), shares_[b]);
            for (std::size_t j = 0; j <= i; ++j) matrix[rows_[b][i] * size + rows_[b][j]] += shares_[b][j];
        }
    }
    // Motions may be linearly dependent, as those of a patch with two points, or of a flat one without friction. They
    // cancel to rounding.
    constexpr double kShift = 1e-6;
    for (std::size_t i = 0; i < size; ++i) matrix[i * size + i] *= 1.0 + kShift;
    if (size > 0 && factor_.factorise(matrix, static_cast<int>(size)))
        sums_.resize(size);
    else
        clear();
}

void PatchCorrection::project(std::span<const CoupledBody> bodies)
{
    std::ranges::fill(sums_, 0.0);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (rows_[b].empty()) continue;
        deflationOf(bodies[b])->project(shares_[b]);
        for (std::size_t i = 0; i < rows_[b].size(); ++i) sums_[rows_[b][i]] += shares_[b][i];
    }
    factor_.solve(sums_);
    for (std::size_t b = 0; b < bodies.size(); ++b)
        for (std::size_t i = 0; i < rows_[b].size(); ++i) shares_[b][i] = sums_[rows_[b][i]];
}

} // namespace filasofia::engine
