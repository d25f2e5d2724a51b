#include "filasofia/engine/constraint/coarse_correction.h"

#include <algorithm>
#include <utility>

namespace filasofia::engine {
namespace {

/// The motions, and the impulses M u [N s] that resist them; without those that no constraint resists.
struct Resisted {
    std::vector<ConstraintMotion> motions;
    std::vector<std::vector<Vec3>> impulses; ///< per motion and row
};

Resisted resisted(std::vector<ConstraintMotion>&& motions, std::span<const Mat3> filters)
{
    Resisted out;
    for (ConstraintMotion& motion : motions) {
        std::vector<Vec3> impulses;
        impulses.reserve(motion.rows.size());
        double sum = 0.0;
        for (std::size_t m = 0; m < motion.rows.size(); ++m) {
            impulses.push_back(filters[motion.rows[m]] * motion.u[m]);
            sum += dot(motion.u[m], impulses.back());
        }
        if (!(sum > 0.0)) continue;
        out.motions.push_back(std::move(motion));
        out.impulses.push_back(std::move(impulses));
    }
    return out;
}

/// U^T M U, row by row; its lower half.
std::vector<double> resistance(const Resisted& in, std::size_t rows)
{
    struct Part {
        std::size_t motion;
        Vec3 u, impulse;
    };
    std::vector<std::size_t> end(rows + 1); // where each row's parts end; they follow one another
    for (const ConstraintMotion& motion : in.motions)
        for (std::size_t row : motion.rows) ++end[row + 1];
    for (std::size_t row = 0; row < rows; ++row) end[row + 1] += end[row];
    std::vector<Part> parts(end.back());
    for (std::size_t i = 0; i < in.motions.size(); ++i)
        for (std::size_t m = 0; m < in.motions[i].rows.size(); ++m)
            parts[end[in.motions[i].rows[m]]++] = {i, in.motions[i].u[m], in.impulses[i][m]};
    const std::size_t size = in.motions.size();
    std::vector<double> matrix(size * size);
    for (std::size_t row = 0, first = 0; row < rows; first = end[row++])
        for (std::size_t a = first; a < end[row]; ++a)
            for (std::size_t b = first; b <= a; ++b)
                matrix[parts[a].motion * size + parts[b].motion] += dot(parts[a].u, parts[b].impulse);
    return matrix;
}

/// A body's part of a vector over the picked coarse nodes of all bodies of a tie.
struct PartOf {
    std::size_t first = 0, count = 0;
    std::span<float> operator()(std::span<float> all) const { return all.subspan(first, count); }
};

/// Calls use(body, its picked coarse nodes, its part) for the bodies of a tie.
template <class Use> void forEachPart(const SolvedTie& tie, const Use& use)
{
    PartOf part;
    for (std::size_t k = 0; k < tie.bodies.size(); ++k) {
        const std::span<const int> nodes = tie.coarse->nodesOf(k);
        part = {part.first + part.count, 3 * nodes.size()};
        use(tie.bodies[k], nodes, part);
    }
}

} // namespace

void CoarseCorrection::begin(std::span<const SolvedTie> ties)
{
    clearMotions();
    ties_.clear();
    for (const SolvedTie& each : ties) {
        Tie& made = ties_.emplace_back();
        made.tie = &each;
        made.y.assign(each.coarse->paddedSize(), 0.0f);
        made.c.assign(each.coarse->resultSize(), 0.0f);
    }
}

void CoarseCorrection::clearMotions()
{
    rows_.clear();
    shares_.clear();
    sums_.clear();
}

std::span<const double> CoarseCorrection::shares(std::size_t body) const
{
    return sums_.empty() ? std::span<const double>() : shares_[body];
}

void CoarseCorrection::make(const ConstraintNetwork& network, std::vector<ConstraintMotion> motions)
{
    clearMotions();
    const auto& [bodies, first, rows, filters] = network;
    for (const CoupledBody& body : bodies)
        if (DeflationOperator* deflation = body.deflation()) deflation->clear();
    const Resisted in = resisted(std::move(motions), filters);
    const std::size_t size = in.motions.size();
    std::vector<double> matrix = resistance(in, rows.list.size()); // S, its lower half
    rows_.resize(bodies.size());
    shares_.resize(bodies.size());

    std::vector<Vec3> column(static_cast<std::size_t>(first.back())); // a column of F, at all contact points
    for (std::size_t i = 0; i < size; ++i) {
        std::ranges::fill(column, Vec3{});
        for (std::size_t m = 0; m < in.motions[i].rows.size(); ++m)
            addImpulse(rows, in.motions[i].rows[m], in.impulses[i][m], column);
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            DeflationOperator* deflation = bodies[b].deflation();
            const auto ofBody = std::span(column).subspan(static_cast<std::size_t>(first[b]),
                                                          static_cast<std::size_t>(first[b + 1] - first[b]));
            if (!deflation || std::ranges::all_of(ofBody, [](Vec3 each) { return each == Vec3{}; })) continue;
            deflation->addColumn(ofBody);
            rows_[b].push_back(i);
        }
    }
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        shares_[b].resize(rows_[b].size());
        if (rows_[b].empty()) continue;
        bodies[b].deflation()->finish();
        for (std::size_t i = 0; i < rows_[b].size(); ++i) {
            bodies[b].deflation()->products(static_cast<int>(i), shares_[b]);
            for (std::size_t j = 0; j <= i; ++j) matrix[rows_[b][i] * size + rows_[b][j]] += shares_[b][j];
        }
    }
    // Motions may be linearly dependent, as those of a patch with two points, or of a flat one without friction. They
    // cancel to rounding.
    constexpr double kShift = 1e-6;
    for (std::size_t i = 0; i < size; ++i) matrix[i * size + i] *= 1.0 + kShift;
    addTies(bodies, size, matrix);
    if (size > 0 && factor_.factorise(matrix, static_cast<int>(size)))
        sums_.resize(size);
    else
        clearMotions();
}

/// Computes T and W T, and subtracts T^T W T from S, its lower half.
void CoarseCorrection::addTies(std::span<const CoupledBody> bodies, std::size_t size, std::vector<double>& matrix)
{
    for (Tie& each : ties_) {
        each.t.assign(size * each.y.size(), 0.0f);
        each.wt.assign(size * each.c.size(), 0.0f);
        forEachPart(*each.tie, [&](std::size_t b, std::span<const int> nodes, const PartOf& part) {
            for (std::size_t i = 0; i < rows_[b].size(); ++i)
                bodies[b].deflation()->readColumn(static_cast<int>(i), nodes, part(each.tOf(rows_[b][i])));
        });
        each.tie->coarse->multiply(size, each.t, each.wt);
        each.panels.assign(each.t, size, each.y.size());
        for (std::size_t i = 0; i < size; ++i) {
            const std::span<const float> products = each.products(each.wtOf(i));
            for (std::size_t j = i; j < size; ++j) matrix[j * size + i] -= static_cast<double>(products[j]);
        }
    }
}

/// y, and c = W y
void CoarseCorrection::answerTies(std::span<const CoupledBody> bodies)
{
    for (Tie& each : ties_) {
        forEachPart(*each.tie, [&](std::size_t b, std::span<const int> nodes, const PartOf& part) {
            bodies[b].deflation()->readAnswer(nodes, part(each.y));
        });
        each.tie->coarse->multiply(1, each.y, each.c);
    }
}

/// c -= W T a, s -= E c
void CoarseCorrection::subtractTies(std::span<const CoupledBody> bodies)
{
    for (Tie& each : ties_) {
        for (std::size_t i = 0; i < sums_.size(); ++i) {
            const std::span<const float> wt = each.wtOf(i);
            for (std::size_t k = 0; k < wt.size(); ++k) each.c[k] -= static_cast<float>(sums_[i]) * wt[k];
        }
        forEachPart(*each.tie, [&](std::size_t b, std::span<const int> nodes, const PartOf& part) {
            bodies[b].deflation()->subtract(nodes, part(each.c));
        });
    }
}

void CoarseCorrection::project(std::span<const CoupledBody> bodies)
{
    answerTies(bodies);
    projectMotions(bodies);
    subtractTies(bodies);
}

void CoarseCorrection::projectMotions(std::span<const CoupledBody> bodies)
{
    if (sums_.empty()) return;
    std::ranges::fill(sums_, 0.0);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (rows_[b].empty()) continue;
        bodies[b].deflation()->project(shares_[b]);
        for (std::size_t i = 0; i < rows_[b].size(); ++i) sums_[rows_[b][i]] += shares_[b][i];
    }
    for (Tie& each : ties_) {
        const std::span<const float> products = each.products(each.c);
        for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] -= static_cast<double>(products[i]);
    }
    factor_.solve(sums_);
    for (std::size_t b = 0; b < bodies.size(); ++b)
        for (std::size_t i = 0; i < rows_[b].size(); ++i) shares_[b][i] = sums_[rows_[b][i]];
}

} // namespace filasofia::engine
