// What a MatrixFreeSystem knows of hard-pinned nodes, which are no unknowns of its equations.
#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/soft/matrix_free_system.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

/// The blocks of the listed elements, as ranges of blocks that follow one another.
std::vector<linalg::Blocks> blocksOf(const std::vector<int>& elements)
{
    std::vector<linalg::Blocks> all;
    for (int element : elements) {
        const int block = element / kBlock;
        if (!all.empty() && block <= all.back().end)
            all.back().end = std::max(all.back().end, block + 1);
        else
            all.push_back({block, block + 1});
    }
    return all;
}

} // namespace

void MatrixFreeSystem::keepHeld(const SoftModel& model, const PinnedParts& held)
{
    if (!heldListed_) listHeldCorners(model, held);
    heldImpulses_.assign(static_cast<std::size_t>(heldNodes_), Vec3{});
    addHeldCorners(1.0 / scale_);
}

void MatrixFreeSystem::addHeldForces(double dt, const SoftModel& model, const PinnedParts& held,
                                     std::span<const Vec3> dv, WorkerPool& pool, std::span<Vec3> forces)
{
    if (std::holds_alternative<physics::ImplicitEuler>(model.integrator)) {
        load(dv, {}, scratch_, pool);
        multiplyHeld(held, scratch_, pool);
        addHeldCorners(-1.0 / scale_);
    }
    const int* nodes = nodeOf_.data() + static_cast<std::ptrdiff_t>(kBlock) * freeBlocks_;
    for (std::size_t i = 0; i < heldImpulses_.size(); ++i) forces[nodes[i]] += 1.0 / dt * heldImpulses_[i];
}

void MatrixFreeSystem::multiplyHeld(const PinnedParts& held, const linalg::NodeArray& p, WorkerPool& pool)
{
    const std::span<float> all = floats(corners_), ofElements = all.first(kElementCorners * elements_.size());
    if (volumes_.empty()) {
        for (linalg::Blocks blocks : heldBlocks_) multiplyElements(tangents_, fibreTangents_, p, ofElements, blocks);
    } else { // elements that share nodes share their volumes, too
        multiplyElements(tangents_, fibreTangents_, p, ofElements, {0, static_cast<int>(elements_.size())});
        volumes_.multiply(p, pool, ofElements);
    }
    if (!held.springs.empty())
        multiplySprings(springMatrices_, p, all.subspan(ofElements.size()),
                        {0, static_cast<int>(springMatrices_.size())});
    if (!held.membranes.empty()) shell_.multiply(p, all.last(64 * shell_.groups()), pool);
}

void MatrixFreeSystem::listHeldCorners(const SoftModel& model, const PinnedParts& held)
{
    heldCorners_.clear();
    const int first = kBlock * freeBlocks_;
    /// `group`: the first of one group of sixteen corners per node; each part has a lane of its own in them.
    const auto add = [&](const auto& nodes, std::size_t group, int part) {
        for (std::size_t k = 0; k < nodes.size(); ++k)
            if (const int slot = slotOf_[static_cast<std::size_t>(nodes[k])]; slot >= first)
                heldCorners_.push_back(
                    {static_cast<int>(64 * (group + k)) + linalg::laneOffset(part % kBlock), slot - first});
    };
    const auto block = [](int part) { return static_cast<std::size_t>(part / kBlock); };
    for (int e : held.elements) add(model.elements[static_cast<std::size_t>(e)].nodes, 4 * block(e), e);
    const std::size_t springs = 4 * elements_.size();
    for (int s : held.springs) add(model.springs[static_cast<std::size_t>(s)].nodes, springs + 2 * block(s), s);
    const std::size_t membranes = corners_.size() - shell_.groups();
    for (int m : held.membranes)
        add(model.shell.membranes[static_cast<std::size_t>(m)].nodes, membranes + 3 * block(m), m);
    const std::size_t bends = membranes + shell_.membraneGroups();
    for (int b : held.bends) add(model.shell.bends[static_cast<std::size_t>(b)].nodes, bends + 6 * block(b), b);
    heldBlocks_ = blocksOf(held.elements);
    heldListed_ = true;
}

void MatrixFreeSystem::addHeldCorners(double factor)
{
    const float* all = floats(corners_).data();
    for (const HeldCorner& each : heldCorners_) {
        const float* at = all + each.corner;
        heldImpulses_[static_cast<std::size_t>(each.pin)] += factor * Vec3{at[0], at[1], at[2]};
    }
}

} // namespace filasofia::engine
