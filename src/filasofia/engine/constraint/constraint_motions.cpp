#include "filasofia/engine/constraint/constraint_motions.h"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

namespace filasofia::engine {
namespace {

constexpr std::size_t kMaxPatches = 256;     // those with the most constraints
constexpr std::size_t kMaxCoarseNodes = 128; // each is coupled with most others

/// A filter is positive semi-definite.
bool isActive(const Mat3& filter) { return trace(filter) > 0.0; }

using Patch = std::vector<std::size_t>; ///< rows

Vec3 rowPosition(const ConstraintRow& row) { return row.constraint->sides[0].position; }

std::vector<Patch> findPatches(const ConstraintNetwork& network)
{
    const auto& [bodies, first, rows, filters] = network;
    std::vector<Patch> patches;
    std::map<std::tuple<std::size_t, std::size_t, bool, std::array<int, 2>>, std::size_t> numberOf;
    for (std::size_t c = 0; c < filters.size(); ++c) {
        const ConstraintRow& row = rows.list[c];
        if (!isActive(filters[c]) || row.constraint->tied) continue;
        if (row.constraint->kind == ConstraintKind::ClipLeg) continue; // they cost more than they save
        const std::span<const WeightedPoint> points = rows.pointsOf(row);
        if (points.empty()) continue; // between points that cannot move
        const std::size_t from = network.bodyOf(points.front().point), to = network.bodyOf(points.back().point);
        if (!bodies[from].deflation() && !bodies[to].deflation()) continue;
        const bool bilateral = row.constraint->bilateral();
        const std::size_t at = numberOf.try_emplace({from, to, bilateral, row.pieces}, patches.size()).first->second;
        if (at == patches.size()) patches.emplace_back();
        patches[at].push_back(c);
    }
    std::ranges::stable_sort(patches, std::ranges::greater{}, &Patch::size);
    if (patches.size() > kMaxPatches) patches.resize(kMaxPatches);
    return patches;
}

/// Adds three translations, and three rotations about the middle.
void addMotions(const Patch& patch, const ConstraintRows& rows, std::vector<ConstraintMotions>& motions)
{
    Vec3 middle;
    double radius = 0.0;
    for (std::size_t c : patch) middle += 1.0 / static_cast<double>(patch.size()) * rowPosition(rows.list[c]);
    for (std::size_t c : patch) radius = std::max(radius, length(rowPosition(rows.list[c]) - middle));
    motions.push_back({patch, std::vector<Mat3>(patch.size(), Mat3::identity())});
    if (radius == 0.0) return;
    ConstraintMotions& turns = motions.emplace_back(ConstraintMotions{patch, {}});
    for (std::size_t c : patch)
        turns.u.push_back(1.0 / radius * transpose(crossMatrix(rowPosition(rows.list[c]) - middle)));
}

/// Adds J P of a row to the coarse nodes that its points follow. `placeOf`: per body and coarse node, its place in
/// `nodes`; -1 if it has none yet.
void addRow(const ConstraintNetwork& network, std::size_t row, std::vector<std::vector<int>>& placeOf,
            std::vector<ConstraintMotions>& nodes)
{
    std::vector<BlockColumns> columns;
    for (const WeightedPoint& each : network.rows.pointsOf(network.rows.list[row])) {
        const std::size_t body = network.bodyOf(each.point);
        const DeflationOperator* deflation = network.bodies[body].deflation();
        if (!deflation) continue;
        columns.clear();
        deflation->addCoarseColumns(each.point - network.first[body], columns);
        for (const auto& [block, j] : columns) {
            std::vector<int>& places = placeOf[body];
            places.resize(std::max(places.size(), static_cast<std::size_t>(block) + 1), -1);
            int& place = places[static_cast<std::size_t>(block)];
            if (place < 0) {
                place = static_cast<int>(nodes.size());
                nodes.emplace_back();
            }
            ConstraintMotions& node = nodes[static_cast<std::size_t>(place)];
            if (node.rows.empty() || node.rows.back() != row) {
                node.rows.push_back(row);
                node.u.emplace_back();
            }
            node.u.back() += each.weight * j;
        }
    }
}

} // namespace

std::vector<ConstraintMotions> patchMotions(const ConstraintNetwork& network)
{
    std::vector<ConstraintMotions> motions;
    for (const Patch& patch : findPatches(network)) addMotions(patch, network.rows, motions);
    return motions;
}

std::vector<ConstraintMotions> coarseNodeMotions(const ConstraintNetwork& network)
{
    std::vector<std::vector<int>> placeOf(network.bodies.size());
    std::vector<ConstraintMotions> nodes;
    for (std::size_t row = 0; row < network.filters.size(); ++row) {
        if (isActive(network.filters[row]) && !network.rows.list[row].constraint->tied)
            addRow(network, row, placeOf, nodes);
        if (nodes.size() > kMaxCoarseNodes) return {};
    }
    return nodes;
}

} // namespace filasofia::engine
