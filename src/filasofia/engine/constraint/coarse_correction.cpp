#include "filasofia/engine/constraint/coarse_correction.h"

#include "filasofia/core/sorted.h"

#include <algorithm>
#include <utility>

namespace filasofia::engine {
namespace {

/// Per three motions the impulses M u [N s] that resist them, per row, as columns. Removes motions that none resists.
std::vector<std::vector<Mat3>> impulsesOf(std::vector<ConstraintMotions>& motions, std::span<const Mat3> filters)
{
    std::vector<std::vector<Mat3>> out;
    std::erase_if(motions, [&](const ConstraintMotions& three) {
        std::vector<Mat3> impulses;
        impulses.reserve(three.rows.size());
        double sum = 0.0;
        for (std::size_t m = 0; m < three.rows.size(); ++m) {
            impulses.push_back(filters[three.rows[m]] * three.u[m]);
            sum += trace(transposeTimes(three.u[m], impulses.back()));
        }
        if (!(sum > 0.0)) return true;
        out.push_back(std::move(impulses));
        return false;
    });
    return out;
}

/// Adds U^T M U, row by row.
void addResistance(const std::vector<ConstraintMotions>& motions, const std::vector<std::vector<Mat3>>& impulses,
                   std::size_t rows, MotionMatrix& s)
{
    struct Part {
        std::size_t motions;
        const Mat3 *u, *impulse;
    };
    std::vector<std::size_t> end(rows + 1); // where each row's parts end; they follow one another
    for (const ConstraintMotions& three : motions)
        for (std::size_t row : three.rows) ++end[row + 1];
    for (std::size_t row = 0; row < rows; ++row) end[row + 1] += end[row];
    std::vector<Part> parts(end.back());
    for (std::size_t i = 0; i < motions.size(); ++i)
        for (std::size_t m = 0; m < motions[i].rows.size(); ++m)
            parts[end[motions[i].rows[m]]++] = {i, &motions[i].u[m], &impulses[i][m]};
    for (std::size_t row = 0, first = 0; row < rows; first = end[row++])
        for (std::size_t a = first; a < end[row]; ++a)
            for (std::size_t b = first; b <= a; ++b)
                s.add(parts[a].motions, parts[b].motions, transposeTimes(*parts[a].u, *parts[b].impulse));
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
    threes_.clear();
    shares_.clear();
    sums_.clear();
}

std::span<const double> CoarseCorrection::shares(std::size_t body) const
{
    return sums_.empty() ? std::span<const double>() : shares_[body];
}

void CoarseCorrection::make(const ConstraintNetwork& network, std::vector<ConstraintMotions> motions)
{
    clearMotions();
    const std::span<const CoupledBody> bodies = network.bodies;
    for (const CoupledBody& body : bodies)
        if (DeflationOperator* deflation = body.deflation()) deflation->clear();
    const std::vector<std::vector<Mat3>> impulses = impulsesOf(motions, network.filters);
    s_.begin(motions.size());
    addResistance(motions, impulses, network.rows.list.size(), s_);
    threes_.resize(bodies.size());
    shares_.resize(bodies.size());
    for (std::size_t i = 0; i < motions.size(); ++i) addColumns(network, motions[i], impulses[i], i);
    for (std::size_t b = 0; b < bodies.size(); ++b)
        if (!threes_[b].empty()) addBody(*bodies[b].deflation(), b);
    s_.shiftDiagonal();
    addTies(bodies, motions.size());
    if (!motions.empty() && s_.factorise())
        sums_.resize(motions.size());
    else
        clearMotions();
}

/// Three columns of F, at the contact points of the bodies that they reach.
void CoarseCorrection::addColumns(const ConstraintNetwork& network, const ConstraintMotions& motions,
                                  std::span<const Mat3> impulses, std::size_t number)
{
    const auto& [bodies, first, rows, filters] = network;
    std::vector<std::size_t> reached;
    for (std::size_t row : motions.rows)
        for (const WeightedPoint& each : rows.pointsOf(rows.list[row])) reached.push_back(network.bodyOf(each.point));
    sortUnique(reached);
    std::erase_if(reached, [&](std::size_t b) { return network.bodies[b].deflation() == nullptr; });
    column_.resize(static_cast<std::size_t>(first.back())); // zero in between
    for (int axis = 0; axis < 3; ++axis) {
        for (std::size_t m = 0; m < motions.rows.size(); ++m)
            addImpulse(rows, motions.rows[m], impulses[m].column(axis), column_);
        for (std::size_t b : reached)
            bodies[b].deflation()->addColumn(std::span(column_).subspan(
                static_cast<std::size_t>(first[b]), static_cast<std::size_t>(first[b + 1] - first[b])));
        for (std::size_t row : motions.rows)
            for (const WeightedPoint& each : rows.pointsOf(rows.list[row]))
                column_[static_cast<std::size_t>(each.point)] = {};
    }
    for (std::size_t b : reached) threes_[b].push_back(number);
}

/// Adds F^T B F of a body.
void CoarseCorrection::addBody(DeflationOperator& deflation, std::size_t body)
{
    const std::vector<std::size_t>& threes = threes_[body];
    std::vector<double>& products = shares_[body];
    products.resize(3 * threes.size());
    deflation.finish();
    for (std::size_t i = 0; i < threes.size(); ++i) {
        std::vector<Mat3> blocks(i + 1);
        for (std::size_t row = 0; row < 3; ++row) {
            deflation.products(static_cast<int>(3 * i + row), products);
            for (std::size_t j = 0; j <= i; ++j)
                blocks[j][static_cast<int>(row)] = {products[3 * j], products[3 * j + 1], products[3 * j + 2]};
        }
        for (std::size_t j = 0; j <= i; ++j) s_.add(threes[i], threes[j], blocks[j]);
    }
}

/// Computes T and W T, and subtracts T^T W T from S.
void CoarseCorrection::addTies(std::span<const CoupledBody> bodies, std::size_t motions)
{
    for (Tie& each : ties_) {
        const std::size_t size = 3 * motions;
        each.t.assign(size * each.y.size(), 0.0f);
        each.wt.assign(size * each.c.size(), 0.0f);
        std::vector<std::size_t> threes;
        forEachPart(*each.tie, [&](std::size_t b, std::span<const int> nodes, const PartOf& part) {
            for (std::size_t i = 0; i < 3 * threes_[b].size(); ++i)
                bodies[b].deflation()->readColumn(static_cast<int>(i), nodes,
                                                  part(each.tOf(3 * threes_[b][i / 3] + i % 3)));
            threes.insert(threes.end(), threes_[b].begin(), threes_[b].end());
        });
        sortUnique(threes);
        each.tie->coarse->multiply(size, each.t, each.wt);
        each.panels.assign(each.t, size, each.y.size());
        for (std::size_t i : threes) {
            std::vector<Mat3> blocks(threes.size());
            for (std::size_t row = 0; row < 3; ++row) {
                const auto products = each.products(each.wtOf(3 * i + row));
                for (std::size_t k = 0; k < threes.size(); ++k)
                    for (std::size_t column = 0; column < 3; ++column)
                        blocks[k][static_cast<int>(row)][static_cast<int>(column)] =
                            -static_cast<double>(products[3 * threes[k] + column]);
            }
            for (std::size_t k = 0; k < threes.size() && threes[k] <= i; ++k) s_.add(i, threes[k], blocks[k]);
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
        for (std::size_t i = 0; i < 3 * sums_.size(); ++i) {
            const std::span<const float> wt = each.wtOf(i);
            const auto sum = static_cast<float>(sums_[i / 3][static_cast<int>(i % 3)]);
            for (std::size_t k = 0; k < wt.size(); ++k) each.c[k] -= sum * wt[k];
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
    std::ranges::fill(sums_, Vec3{});
    const auto threeOf = [](std::span<const double> all, std::size_t i) {
        return Vec3{all[3 * i], all[3 * i + 1], all[3 * i + 2]};
    };
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (threes_[b].empty()) continue;
        bodies[b].deflation()->project(shares_[b]);
        for (std::size_t i = 0; i < threes_[b].size(); ++i) sums_[threes_[b][i]] += threeOf(shares_[b], i);
    }
    for (Tie& each : ties_) {
        const std::span<const float> products = each.products(each.c);
        for (std::size_t i = 0; i < 3 * sums_.size(); ++i)
            sums_[i / 3][static_cast<int>(i % 3)] -= static_cast<double>(products[i]);
    }
    s_.solve(sums_);
    for (std::size_t b = 0; b < bodies.size(); ++b)
        for (std::size_t i = 0; i < shares_[b].size(); ++i)
            shares_[b][i] = sums_[threes_[b][i / 3]][static_cast<int>(i % 3)];
}

} // namespace filasofia::engine
