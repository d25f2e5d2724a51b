#include "filasofia/engine/constraint/constraint_motions.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

// S of CoarseCorrection is dense.
constexpr std::size_t kMaxPatches = 32; // those with the most constraints
constexpr std::size_t kMaxCoarseNodes = 128;

/// A filter is positive semi-definite.
bool isActive(const Mat3& filter) { return trace(filter) > 0.0; }

struct Patch {
    std::size_t from = 0, to = 0; ///< bodies
    bool bilateral = false;
    std::array<int, 2> pieces = {};   ///< in the order of the constraint's sides, not of `from` and `to`
    std::vector<std::size_t> members; ///< rows
};

Vec3 rowPosition(const ConstraintRow& row) { return row.constraint->sides[0].position; }

std::size_t bodyOf(std::span<const int> first, int point)
{
    return static_cast<std::size_t>(std::ranges::upper_bound(first, point) - first.begin()) - 1;
}

std::vector<Patch> findPatches(const ConstraintNetwork& network)
{
    const auto& [bodies, first, rows, filters] = network;
    std::vector<Patch> patches;
    for (std::size_t c = 0; c < filters.size(); ++c) {
        const ConstraintRow& row = rows.list[c];
        if (!isActive(filters[c]) || row.constraint->tied) continue;
        if (row.constraint->kind == ConstraintKind::ClipLeg) continue; // they cost more than they save
        const std::span<const WeightedPoint> points = rows.pointsOf(row);
        if (points.empty()) continue; // between points that cannot move
        const std::size_t from = bodyOf(first, points.front().point), to = bodyOf(first, points.back().point);
        if (!bodies[from].deflation() && !bodies[to].deflation()) continue;
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

/// Adds three translations and three rotations about the middle.
void addMotions(const Patch& patch, const ConstraintRows& rows, std::vector<ConstraintMotion>& motions)
{
    Vec3 middle;
    double radius = 0.0;
    for (std::size_t c : patch.members)
        middle += 1.0 / static_cast<double>(patch.members.size()) * rowPosition(rows.list[c]);
    for (std::size_t c : patch.members) radius = std::max(radius, length(rowPosition(rows.list[c]) - middle));
    for (int k = 0; k < (radius > 0.0 ? 6 : 3); ++k) {
        ConstraintMotion& motion = motions.emplace_back();
        motion.rows = patch.members;
        Vec3 axis;
        axis[k % 3] = 1.0;
        for (std::size_t c : patch.members) {
            const Vec3 u = k < 3 ? axis : 1.0 / radius * cross(axis, rowPosition(rows.list[c]) - middle);
            motion.u.push_back(u);
        }
    }
}

/// The velocities of active constraints per velocity of one coarse node.
struct CoarseNode {
    std::vector<std::size_t> rows;
    std::vector<Mat3> u; ///< per row, world axes
};

/// Adds J P of a row to the coarse nodes that its points follow. `placeOf`: per body and coarse node, its place in
/// `nodes`; -1 if it has none yet.
void addRow(const ConstraintNetwork& network, std::size_t row, std::vector<std::vector<int>>& placeOf,
            std::vector<CoarseNode>& nodes)
{
    std::vector<BlockColumns> columns;
    for (const WeightedPoint& each : network.rows.pointsOf(network.rows.list[row])) {
        const std::size_t body = bodyOf(network.first, each.point);
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
            CoarseNode& node = nodes[static_cast<std::size_t>(place)];
            if (node.rows.empty() || node.rows.back() != row) {
                node.rows.push_back(row);
                node.u.emplace_back();
            }
            node.u.back() += each.weight * j;
        }
    }
}

} // namespace

std::vector<ConstraintMotion> patchMotions(const ConstraintNetwork& network)
{
    std::vector<ConstraintMotion> motions;
    for (const Patch& patch : findPatches(network)) addMotions(patch, network.rows, motions);
    return motions;
}

std::vector<ConstraintMotion> coarseNodeMotions(const ConstraintNetwork& network)
{
    std::vector<std::vector<int>> placeOf(network.bodies.size());
    std::vector<CoarseNode> nodes;
    for (std::size_t row = 0; row < network.filters.size(); ++row) {
        if (isActive(network.filters[row]) && !network.rows.list[row].constraint->tied)
            addRow(network, row, placeOf, nodes);
        if (nodes.size() > kMaxCoarseNodes) return {};
    }
    std::vector<ConstraintMotion> motions;
    for (const CoarseNode& node : nodes)
        for (int axis = 0; axis < 3; ++axis) {
            ConstraintMotion& motion = motions.emplace_back();
            motion.rows = node.rows;
            for (const Mat3& u : node.u) motion.u.push_back(u.column(axis));
        }
    return motions;
}

} // namespace filasofia::engine
