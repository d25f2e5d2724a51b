#include "filasofia/engine/soft/shell_system.h"

#include "filasofia/core/worker_pool.h"
#include "filasofia/linalg/node_parts.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

/// The directions of the first edge, and across it in the triangle.
std::array<Vec3, 2> frameOf(const TriangleCorners& rest)
{
    const Vec3 first = normalized(rest[1] - rest[0]);
    return {first, normalized(cross(normalized(cross(rest[1] - rest[0], rest[2] - rest[0])), first))};
}

Mat3 symmetricAt(const float (&m)[6][kBlock], std::size_t lane)
{
    const auto at = [&](std::size_t k) { return static_cast<double>(m[k][lane]); };
    return {{{at(0), at(1), at(2)}, {at(1), at(3), at(4)}, {at(2), at(4), at(5)}}};
}

Vec3 vectorAt(const float (&v)[3][kBlock], std::size_t lane) { return {v[0][lane], v[1][lane], v[2][lane]}; }

/// The gradients of the three angles of a triangle by its six corners.
std::array<std::array<Vec3, 3>, 6> gradientsAt(const BendingTangentBlock& tangent, std::size_t lane)
{
    std::array<std::array<Vec3, 3>, 6> gradients{};
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 own = vectorAt(tangent.own[i], lane), across = vectorAt(tangent.across[i], lane);
        const Vec3 second = static_cast<double>(tangent.feet[i][0][lane]) * own +
                            static_cast<double>(tangent.feet[i][1][lane]) * across;
        gradients[i][i] = -own;
        gradients[3 + i][i] = -across;
        gradients[(i + 1) % 3][i] = own + across - second;
        gradients[(i + 2) % 3][i] = second;
    }
    return gradients;
}

std::size_t blocksOf(std::size_t count) { return static_cast<std::size_t>(linalg::blocksFor(static_cast<int>(count))); }

} // namespace

ShellSystem::ShellSystem(const Shell& shell, std::span<const Vec3> rest, std::span<const int> slotOf, double scale,
                         bool grows)
    : scale_(scale), used_(blocksOf(shell.membranes.size())), count_(shell.membranes.size()),
      membranes_(grows && used_ > 0 ? used_ + used_ / 4 + 1 : used_), membraneTangents_(membranes_.size()),
      bends_(blocksOf(shell.bends.size())), bendingTangents_(bends_.size())
{
    for (std::size_t lane = 0; lane < kBlock * used_; ++lane) writeMembrane(shell, rest, slotOf, lane);
    for (std::size_t lane = 0; lane < kBlock * bends_.size(); ++lane) writeBend(shell, slotOf, lane);
}

// Unused lanes repeat the last triangle, without stiffness.
void ShellSystem::writeMembrane(const Shell& shell, std::span<const Vec3> rest, std::span<const int> slotOf,
                                std::size_t lane)
{
    const MembraneElement& e = shell.membranes[std::min(lane, shell.membranes.size() - 1)];
    MembraneBlock& block = membranes_[lane / kBlock];
    const std::size_t l = lane % kBlock;
    for (std::size_t i = 0; i < 3; ++i)
        block.nodes[i][l] = membraneTangents_[lane / kBlock].nodes[i][l] = 4 * slotOf[e.nodes[i]];
    for (std::size_t k = 0; k < 3; ++k) block.metric[k][l] = asFloat(e.metric[k]);
    block.det[l] = asFloat(e.metric[0] * e.metric[2] - e.metric[1] * e.metric[1]);
    block.weight[l] = lane < shell.membranes.size() ? asFloat(scale_ * e.area * e.shear) : 0.0f;
    block.q[l] = asFloat(std::max(1.0 - 2.0 * e.poissonRatio, kLeastQ));
    const std::array<Vec3, 2> frame = frameOf(vectorsAt(e.nodes, rest));
    for (std::size_t k = 0; k < 6; ++k) block.frame[k][l] = asFloat(frame[k / 3][static_cast<int>(k % 3)]);
}

void ShellSystem::writeBend(const Shell& shell, std::span<const int> slotOf, std::size_t lane)
{
    const BendingElement& e = shell.bends[std::min(lane, shell.bends.size() - 1)];
    BendingBlock& block = bends_[lane / kBlock];
    const std::size_t l = lane % kBlock;
    for (std::size_t i = 0; i < 6; ++i)
        block.nodes[i][l] = bendingTangents_[lane / kBlock].nodes[i][l] = 4 * slotOf[e.nodes[i]];
    for (std::size_t k = 0; k < 3; ++k) block.restAngles[k][l] = asFloat(e.restAngles[k]);
    const double weight = lane < shell.bends.size() ? scale_ * e.rigidity : 0.0;
    for (std::size_t k = 0; k < 6; ++k) block.stiffness[k][l] = asFloat(weight * e.shape[k]);
    block.leastArea[l] = asFloat(e.leastArea);
}

void ShellSystem::forEachCorner(const Shell& shell, const Add& add, const Add& turn) const
{
    for (std::size_t e = 0; e < shell.membranes.size(); ++e)
        for (std::size_t i = 0; i < 3; ++i) {
            const int node = shell.membranes[e].nodes[i], lane = static_cast<int>(e % kBlock);
            add(node, 3 * (e / kBlock) + i, lane);
            turn(node, e / kBlock, lane);
        }
    for (std::size_t e = 0; e < shell.bends.size(); ++e)
        for (std::size_t i = 0; i < 6; ++i)
            add(shell.bends[e].nodes[i], membraneGroups() + 6 * (e / kBlock) + i, static_cast<int>(e % kBlock));
}

void ShellSystem::update(const BlockInput& input, std::span<float> corners, std::span<float> quaternions,
                         WorkerPool& pool)
{
    const std::span<float> stretching = corners.first(kMembraneCorners * membranes_.size());
    const std::span<float> bending = corners.subspan(stretching.size());
    const linalg::Parts membranes = elementParts(used_), bends = elementParts(bends_.size());
    pool.run(membranes.count(), [&](int part) {
        updateMembranes(membranes_, input, membranes[part], {membraneTangents_, stretching, quaternions});
    });
    pool.run(bends.count(), [&](int part) { updateBends(bends_, input, bends[part], {bendingTangents_, bending}); });
}

void ShellSystem::multiply(const linalg::NodeArray& p, std::span<float> corners, WorkerPool& pool) const
{
    const std::span<float> stretching = corners.first(kMembraneCorners * membranes_.size());
    const std::span<float> bending = corners.subspan(stretching.size());
    const linalg::Parts membranes = elementParts(used_), bends = elementParts(bends_.size());
    pool.run(membranes.count(),
             [&](int part) { multiplyMembranes(membraneTangents_, p, stretching, membranes[part]); });
    pool.run(bends.count(), [&](int part) { multiplyBends(bendingTangents_, p, bending, bends[part]); });
}

void ShellSystem::addDiagonal(std::span<Mat3> blocks) const
{
    const auto add = [&](int place, const Mat3& block) { // pinned nodes come after the free ones
        if (const auto slot = static_cast<std::size_t>(place / 4); slot < blocks.size()) blocks[slot] += block;
    };
    for (std::size_t e = 0; e < count_; ++e) {
        const MembraneTangentBlock& t = membraneTangents_[e / kBlock];
        const std::size_t lane = e % kBlock;
        const Mat3 aa = symmetricAt(t.aa, lane), bb = symmetricAt(t.bb, lane);
        const auto row = [&](std::size_t k) { return Vec3{t.ab[k][lane], t.ab[k + 1][lane], t.ab[k + 2][lane]}; };
        const Mat3 ab{{row(0), row(3), row(6)}};
        add(t.nodes[0][lane], aa + bb + ab + transpose(ab));
        add(t.nodes[1][lane], aa);
        add(t.nodes[2][lane], bb);
    }
    for (std::size_t e = 0; e < kBlock * bends_.size(); ++e) {
        const BendingTangentBlock& t = bendingTangents_[e / kBlock];
        const std::size_t lane = e % kBlock;
        const Mat3 s = symmetricAt(t.stiffness, lane);
        const auto gradients = gradientsAt(t, lane);
        for (std::size_t n = 0; n < gradients.size(); ++n) { // sum of S_ij g_i g_j^T
            const std::array<Vec3, 3>& g = gradients[n];
            Mat3 block;
            for (int i = 0; i < 3; ++i)
                block += outer(s[i].x * g[0] + s[i].y * g[1] + s[i].z * g[2], g[static_cast<std::size_t>(i)]);
            add(t.nodes[n][lane], block);
        }
    }
}

bool ShellSystem::fits(const Shell& shell, double perStiffness)
{
    const auto usual = [](double value) { return value == 0.0 || (value > 1e-12 && value < 1e12); };
    for (const MembraneElement& e : shell.membranes) {
        const double steepest = std::max(e.metric[0], e.metric[2]);
        if (!usual(steepest) || !usual(perStiffness * e.area * e.shear * steepest)) return false;
        if (!usual(e.metric[0] * e.metric[2] / steepest)) return false;
    }
    for (const BendingElement& e : shell.bends) {
        if (!usual(std::sqrt(e.leastArea))) return false;
        for (std::size_t i : {0, 3, 5})
            if (!usual(perStiffness * e.rigidity * e.shape[i] / std::sqrt(e.leastArea))) return false;
    }
    return true;
}

} // namespace filasofia::engine
