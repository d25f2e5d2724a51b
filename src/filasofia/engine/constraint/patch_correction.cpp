#include "filasofia/engine/constraint/patch_correction.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

constexpr std::size_t kMost = 32; // patches: those with the most constraints; S is dense

struct Patch {
    std::size_t from = 0, to = 0; ///< bodies
    bool held = false;
    std::array<int, 2> pieces = {};   ///< in the order of the link's sides, not of `from` and `to`
    std::vector<std::size_t> members; ///< constraints
};

/// A way in which one side of a patch may move against the other.
struct Motion {
    const Patch* patch = nullptr;
    std::vector<Vec3> u;       ///< [m/s] per member, in its frame
    std::vector<Vec3> impulse; ///< [N s] M u
};

std::size_t bodyOf(std::span<const int> first, int grip)
{
    return static_cast<std::size_t>(std::ranges::upper_bound(first, grip) - first.begin()) - 1;
}

std::vector<Patch> findPatches(const std::vector<CoupledBody*>& bodies, std::span<const int> first,
                               const Constraints& constraints, std::span<const Mat3> filters)
{
    std::vector<Patch> patches;
    for (std::size_t c = 0; c < filters.size(); ++c) {
        const Constraint& constraint = constraints.list[c];
        if (filters[c][0].x == 0.0) continue;
        const auto at = [&](int g) { return bodyOf(first, constraints.grips[static_cast<std::size_t>(g)].grip); };
        const std::size_t from = at(constraint.first), to = at(constraint.first + constraint.count - 1);
        if (!bodies[from]->correctable() && !bodies[to]->correctable()) continue;
        const bool held = constraint.friction < 0.0;
        const auto same = [&](const Patch& p) {
            return p.from == from && p.to == to && p.held == held && p.pieces == constraint.pieces;
        };
        auto found = std::ranges::find_if(patches, same);
        if (found == patches.end()) found = patches.insert(found, {from, to, held, constraint.pieces, {}});
        found->members.push_back(c);
    }
    std::ranges::stable_sort(patches, std::ranges::greater{}, [](const Patch& p) { return p.members.size(); });
    if (patches.size() > kMost) patches.resize(kMost);
    return patches;
}

/// Three shifts, three turns about the middle; without those that nothing resists.
void addMotions(const Patch& patch, const Constraints& constraints, std::span<const Mat3> filters,
                std::vector<Motion>& motions)
{
    Vec3 middle;
    double radius = 0.0;
    for (std::size_t c : patch.members)
        middle += 1.0 / static_cast<double>(patch.members.size()) * constraints.list[c].point;
    for (std::size_t c : patch.members) radius = std::max(radius, length(constraints.list[c].point - middle));
    for (int k = 0; k < (radius > 0.0 ? 6 : 3); ++k) {
        Motion motion;
        motion.patch = &patch;
        Vec3 axis;
        axis[k % 3] = 1.0;
        double resisted = 0.0;
        for (std::size_t c : patch.members) {
            const Constraint& constraint = constraints.list[c];
            const Vec3 u = k < 3 ? axis : 1.0 / radius * cross(axis, constraint.point - middle);
            motion.u.push_back(inFrame(constraint.frame, u));
            motion.impulse.push_back(filters[c] * motion.u.back());
            resisted += dot(motion.u.back(), motion.impulse.back());
        }
        if (resisted > 0.0) motions.push_back(std::move(motion));
    }
}

/// J^T M u: what the motion's impulses are at the grips, of which there are as many as `pulls`.
void pullsOf(const Motion& motion, const Constraints& constraints, std::vector<Vec3>& pulls)
{
    std::ranges::fill(pulls, Vec3{});
    for (std::size_t m = 0; m < motion.impulse.size(); ++m)
        giveImpulse(constraints, motion.patch->members[m], motion.impulse[m], pulls);
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

void PatchCorrection::make(const std::vector<CoupledBody*>& bodies, std::span<const int> first,
                           const Constraints& constraints, std::span<const Mat3> filters)
{
    clear();
    for (CoupledBody* body : bodies) body->clearPulls();
    const std::vector<Patch> patches = findPatches(bodies, first, constraints, filters);
    std::vector<Motion> motions;
    for (const Patch& patch : patches) addMotions(patch, constraints, filters, motions);
    const std::size_t size = motions.size();
    std::vector<double> matrix(size * size); // S, its lower half
    rows_.resize(bodies.size());
    shares_.resize(bodies.size());

    std::vector<Vec3> pulls(static_cast<std::size_t>(first.back()));
    for (std::size_t i = 0; i < size; ++i) {
        const Patch& patch = *motions[i].patch;
        for (std::size_t j = 0; j <= i; ++j)
            for (std::size_t m = 0; m < patch.members.size() && motions[j].patch == &patch; ++m)
                matrix[i * size + j] += dot(motions[i].u[m], motions[j].impulse[m]);
        pullsOf(motions[i], constraints, pulls);
        const auto tell = [&](std::size_t b) {
            if (!bodies[b]->correctable()) return;
            bodies[b]->addPull(std::span(pulls).subspan(static_cast<std::size_t>(first[b]),
                                                        static_cast<std::size_t>(first[b + 1] - first[b])));
            rows_[b].push_back(i);
        };
        tell(patch.from);
        if (patch.to != patch.from) tell(patch.to);
    }
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        shares_[b].resize(rows_[b].size());
        if (!rows_[b].empty()) bodies[b]->answerPulls();
        for (std::size_t i = 0; i < rows_[b].size(); ++i) {
            bodies[b]->answers(static_cast<int>(i), shares_[b]);
            for (std::size_t j = 0; j <= i; ++j) matrix[rows_[b][i] * size + rows_[b][j]] += shares_[b][j];
        }
    }
    // Motions that come to the same, as of a patch with two points, or a flat one without friction, cancel to rounding.
    constexpr double kShift = 1e-6;
    for (std::size_t i = 0; i < size; ++i) matrix[i * size + i] *= 1.0 + kShift;
    if (size > 0 && factor_.factorise(matrix, static_cast<int>(size)))
        sums_.resize(size);
    else
        clear();
}

void PatchCorrection::weigh(const std::vector<CoupledBody*>& bodies)
{
    std::ranges::fill(sums_, 0.0);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (rows_[b].empty()) continue;
        bodies[b]->weigh(shares_[b]);
        for (std::size_t i = 0; i < rows_[b].size(); ++i) sums_[rows_[b][i]] += shares_[b][i];
    }
    factor_.solve(sums_);
    for (std::size_t b = 0; b < bodies.size(); ++b)
        for (std::size_t i = 0; i < rows_[b].size(); ++i) shares_[b][i] = sums_[rows_[b][i]];
}

} // namespace filasofia::engine
