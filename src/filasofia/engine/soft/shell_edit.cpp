// Updates the triangles of a ShellSystem after an edit of its mesh, only where the edit has changed the mesh.
#include "filasofia/engine/soft/shell_system.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

constexpr int kGroup = 64; // floats of sixteen vectors

int placeIn(std::size_t group, std::size_t lane)
{
    return static_cast<int>(group) * kGroup + linalg::laneOffset(static_cast<int>(lane));
}

/// The lane to which a place in a group points.
int laneAt(int place) { return place % kGroup / kBlock + 4 * (place % kGroup % kBlock / 4); }

/// The entry of the list of rotations for the triangle to whose corner a place points.
int turnOf(int place) { return place / kGroup / 3 * 4 * kGroup + place % kGroup; }

} // namespace

bool ShellSystem::hasRoomFor(const Shell& shell) const
{
    return static_cast<std::size_t>(linalg::blocksFor(static_cast<int>(shell.membranes.size()))) <= membranes_.size();
}

/// The corner is at another node now; slots < 0: at none.
void ShellSystem::moveCorner(int before, int after, std::size_t group, std::size_t lane, const Around& around) const
{
    if (before == after) return;
    const int place = placeIn(group, lane);
    if (before >= 0 && before < around.freeNodes) around.corners.remove(static_cast<std::size_t>(before), place);
    if (after < around.freeNodes) around.corners.add(static_cast<std::size_t>(after), place);
}

/// Call it after moveCorner(): a node that lost all of its rotations takes one of the triangles that it has left.
void ShellSystem::moveTurn(int before, int after, std::size_t lane, const Around& around) const
{
    if (before == after) return;
    const int place = placeIn(4 * (lane / kBlock), lane % kBlock), membranes = static_cast<int>(3 * membranes_.size());
    if (before >= 0 && before < around.freeNodes) {
        const auto list = static_cast<std::size_t>(before);
        if (around.turns.contains(list, place)) around.turns.remove(list, place);
        const int* end = around.corners.end(list);
        const int* left =
            std::find_if(around.corners.begin(list), end, [&](int corner) { return corner / kGroup < membranes; });
        if (around.turns.size(list) == 0 && left != end) around.turns.add(list, turnOf(*left));
    }
    if (after < around.freeNodes && around.turns.size(static_cast<std::size_t>(after)) < around.mostTurns)
        around.turns.add(static_cast<std::size_t>(after), place);
}

void ShellSystem::edit(const Shell& shell, std::span<const Vec3> rest, std::span<const int> slotOf,
                       std::span<const int> triangles, const Around& around)
{
    used_ = static_cast<std::size_t>(linalg::blocksFor(static_cast<int>(shell.membranes.size())));
    if (!shell.bends.empty()) {
        bends_.resize(used_);
        bendingTangents_.resize(used_);
    }
    for (int each : triangles) {
        const auto lane = static_cast<std::size_t>(each), block = lane / kBlock, l = lane % kBlock;
        const bool known = lane < count_;
        count_ = std::max(count_, lane + 1);
        for (std::size_t i = 0; i < 3; ++i) {
            const int before = known ? membranes_[block].nodes[i][l] / 4 : -1;
            const int after = slotOf[static_cast<std::size_t>(shell.membranes[lane].nodes[i])];
            moveCorner(before, after, 3 * block + i, l, around);
            moveTurn(before, after, lane, around);
        }
        writeMembrane(shell, rest, slotOf, lane);
        for (std::size_t i = 0; i < 6 && !shell.bends.empty(); ++i) {
            const int before = known ? bends_[block].nodes[i][l] / 4 : -1;
            const int after = slotOf[static_cast<std::size_t>(shell.bends[lane].nodes[i])];
            moveCorner(before, after, 3 * membranes_.size() + 6 * block + i, l, around);
        }
        if (!shell.bends.empty()) writeBend(shell, slotOf, lane);
    }
    for (std::size_t lane = count_; lane < kBlock * used_; ++lane) { // the rest of the last block
        writeMembrane(shell, rest, slotOf, lane);
        if (!shell.bends.empty()) writeBend(shell, slotOf, lane);
    }
}

Mat3 ShellSystem::diagonalAtRest(const Shell& shell, std::span<const Vec3> rest, ImplicitWeights weights,
                                 std::span<const int> corners) const
{
    Mat3 sum;
    const auto membranes = static_cast<int>(3 * membranes_.size());
    for (int place : corners) {
        const int group = place / kGroup;
        if (group < membranes) {
            const MembraneElement& e = shell.membranes[static_cast<std::size_t>(group / 3 * kBlock + laneAt(place))];
            sum += stiffnessBlock(membraneTangent(e, vectorsAt(e.nodes, rest)), group % 3, group % 3);
        } else {
            const int of = group - membranes;
            const BendingElement& e = shell.bends[static_cast<std::size_t>(of / 6 * kBlock + laneAt(place))];
            sum += stiffnessBlock(bendingTangent(e, vectorsAt(e.nodes, rest)), of % 6, of % 6);
        }
    }
    return scale_ * weights.stiffness * sum;
}

} // namespace filasofia::engine
