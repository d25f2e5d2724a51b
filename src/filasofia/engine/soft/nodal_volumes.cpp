#include "filasofia/engine/soft/nodal_volumes.h"

#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/body/nodal_volume.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

constexpr int kSlotsPerPart = 512;

} // namespace

NodalVolumes::NodalVolumes(const SoftModel& model, std::span<const int> slotOf, std::size_t slots, double scale)
    : scale_(scale), inverse_(slots), pressures_(slots)
{
    std::vector<std::vector<int>> around(slots);
    for (std::size_t e = 0; e < model.elements.size(); ++e)
        for (int node : model.elements[e].nodes)
            around[static_cast<std::size_t>(slotOf[static_cast<std::size_t>(node)])].push_back(static_cast<int>(e));
    around_ = linalg::Lists<int>(around);
    resize(static_cast<std::size_t>(linalg::blocksFor(static_cast<int>(model.elements.size()))));
    for (std::size_t e = 0; e < model.elements.size(); ++e) setShare(model.elements[e], static_cast<int>(e));
    for (std::size_t slot = 0; slot < slots; ++slot) refresh(static_cast<int>(slot));
}

void NodalVolumes::resize(std::size_t blocks)
{
    blocks_.resize(blocks);
    shares_.resize(kBlock * blocks);
    changes_.resize(kBlock * blocks);
}

void NodalVolumes::moveCorner(int element, int before, int after)
{
    if (before >= 0) around_.remove(static_cast<std::size_t>(before), element);
    around_.add(static_cast<std::size_t>(after), element);
}

void NodalVolumes::setShare(const FemElement& source, int element)
{
    shares_[static_cast<std::size_t>(element)] = static_cast<float>(scale_ * nodalShare(source));
}

void NodalVolumes::refresh(int slot)
{
    float sum = 0.0f;
    const auto list = static_cast<std::size_t>(slot);
    for (const int* e = around_.begin(list); e != around_.end(list); ++e) sum += shares_[static_cast<std::size_t>(*e)];
    inverse_[list] = sum > 0.0f ? 1.0f / sum : 0.0f;
}

Mat3 NodalVolumes::diagonalAtRest(const SoftModel& model, int node, std::span<const int> slotOf) const
{
    const auto list = static_cast<std::size_t>(slotOf[static_cast<std::size_t>(node)]);
    std::vector<std::pair<int, Vec3>> rows; // nodes around, and how their volumes depend on this one
    for (const int* e = around_.begin(list); e != around_.end(list); ++e) {
        const FemElement& element = model.elements[static_cast<std::size_t>(*e)];
        const Vec3 gradient =
            nodalShare(element) *
            element.gradients[static_cast<std::size_t>(std::ranges::find(element.nodes, node) - element.nodes.begin())];
        for (int other : element.nodes) {
            const auto known = std::ranges::find(rows, other, &std::pair<int, Vec3>::first);
            if (known == rows.end())
                rows.emplace_back(other, gradient);
            else
                known->second += gradient;
        }
    }
    Mat3 sum;
    for (const auto& [other, gradient] : rows) {
        const double inverse = inverse_[static_cast<std::size_t>(slotOf[static_cast<std::size_t>(other)])];
        sum += scale_ * inverse * outer(gradient, gradient);
    }
    return sum;
}

void NodalVolumes::assemble(std::span<const ElementBlock> elements, const BlockInput& input, WorkerPool& pool,
                            std::span<float> corners)
{
    if (empty()) return;
    stiffness_ = input.weights.volumeStiffness;
    const linalg::Parts parts = elementParts(blocks_.size());
    pool.run(parts.count(), [&](int part) {
        updateVolumes(elements, shares_, input, parts[part], {blocks_, changes_});
    });
    spread(-1.0f, pool, corners);
}

void NodalVolumes::multiply(const linalg::NodeArray& p, WorkerPool& pool, std::span<float> corners)
{
    if (empty()) return;
    const linalg::Parts parts = elementParts(blocks_.size());
    pool.run(parts.count(), [&](int part) { multiplyVolumes(blocks_, p, parts[part], changes_); });
    spread(stiffness_, pool, corners);
}

void NodalVolumes::spread(float weight, WorkerPool& pool, std::span<float> corners)
{
    const linalg::Parts slots{static_cast<int>(pressures_.size()), kSlotsPerPart};
    pool.run(slots.count(), [&](int part) {
        for (auto slot = static_cast<std::size_t>(slots[part].begin); slot < static_cast<std::size_t>(slots[part].end);
             ++slot) {
            float sum = 0.0f;
            for (const int* e = around_.begin(slot); e != around_.end(slot); ++e)
                sum += changes_[static_cast<std::size_t>(*e)];
            pressures_[slot] = weight * inverse_[slot] * sum;
        }
    });
    const linalg::Parts parts = elementParts(blocks_.size());
    pool.run(parts.count(), [&](int part) { addVolumeForces(blocks_, pressures_, parts[part], corners); });
}

} // namespace filasofia::engine
