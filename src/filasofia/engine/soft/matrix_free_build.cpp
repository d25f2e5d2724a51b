// Builds a MatrixFreeSystem from a model.
#include "filasofia/engine/soft/matrix_free_system.h"

#include "filasofia/engine/elastic/fibre.h"
#include "filasofia/engine/soft/assembled_system.h"
#include "filasofia/engine/soft/coarse_rebuild.h"
#include "filasofia/geometry/space_order.h"
#include "filasofia/linalg/node_parts.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace filasofia::engine {
namespace {

using linalg::NodeArray;

double meanMass(const SoftModel& model)
{
    return std::accumulate(model.masses.begin(), model.masses.end(), 0.0) / static_cast<double>(model.masses.size());
}

/// Keeps at most `maxSize` entries of each list, evenly spaced.
std::vector<std::vector<int>> thinned(std::vector<std::vector<int>> lists, std::size_t maxSize)
{
    for (std::vector<int>& list : lists) {
        if (list.size() <= maxSize) continue;
        for (std::size_t k = 0; k < maxSize; ++k) list[k] = list[k * list.size() / maxSize];
        list.resize(maxSize);
    }
    return lists;
}

} // namespace

MatrixFreeSystem::MatrixFreeSystem(const SoftModel& model, double period)
    : scale_(1.0 / meanMass(model)), period_(period),
      preconditioned_(std::holds_alternative<physics::ImplicitEuler>(model.integrator)), slotOf_(model.rest.size())
{
    orderNodes(model);
    makeElements(model);
    makeSprings(model);
    makeShell(model);
    makeGather(model);
    makeVolumes(model);
    if (preconditioned_)
        preconditioner_ = preconditionerAtRest(model, plan(), coarseChoice(static_cast<std::size_t>(freeNodes_)));
}

MatrixFreeSystem::MatrixFreeSystem(const MatrixFreeSystem& other) = default;
MatrixFreeSystem::~MatrixFreeSystem() = default;

PreconditionerPlan MatrixFreeSystem::plan() const
{
    return {std::span(nodeOf_).first(static_cast<std::size_t>(freeNodes_)), scale_, period_, freeBlocks_,
            preconditioner_.hasClusters()};
}

bool MatrixFreeSystem::fits(const SoftModel& model, double period)
{
    const ImplicitWeights weights = implicitWeights(period, {model.rayleigh.mass, model.rayleigh.stiffness});
    const double scale = 1.0 / meanMass(model);
    if (nearlyIncompressible(model)) return false;
    const auto usual = [](double value) { return value == 0.0 || (value > 1e-12 && value < 1e12); };
    for (double mass : model.masses)
        if (!usual(mass * scale)) return false;
    for (const FemElement& e : model.elements) {
        const auto [mu, lambda] = lame(e.youngModulus, e.poissonRatio);
        const double steepest = std::max({lengthSquared(e.gradients[0]), lengthSquared(e.gradients[1]),
                                          lengthSquared(e.gradients[2]), lengthSquared(e.gradients[3])});
        const double volume = e.volume * scale * steepest;
        if (!usual(weights.stiffness * volume * mu) || !usual(weights.stiffness * volume * lambda)) return false;
        if (!usual(steepest) || !usual(volume * mu / std::sqrt(steepest))) return false;
    }
    for (const physics::FibreFamily& family : model.material.fibres)
        for (double stress : {family.stiffness, family.activeStress})
            if (!usual(weights.stiffness * scale * stress)) return false;
    if (!ShellSystem::fits(model.shell, weights.stiffness * scale)) return false;
    for (const Spring& s : model.springs)
        if (!usual(weights.stiffness * scale * s.stiffness) || !usual(weights.damping * scale * s.damping) ||
            !usual(s.restLength))
            return false;
    return std::all_of(model.pins.springs.begin(), model.pins.springs.end(),
                       [&](const PinSpring& pin) { return usual(weights.stiffness * scale * pin.stiffness); });
}

void MatrixFreeSystem::orderNodes(const SoftModel& model)
{
    const std::vector<int> order = geometry::orderAlongCurve(model.rest);
    std::vector<int> held;
    for (int node : order) (model.pins.hard[node] ? held : nodeOf_).push_back(node);
    free_ = held.empty() && model.pins.springs.empty();
    freeNodes_ = static_cast<int>(nodeOf_.size());
    heldNodes_ = static_cast<int>(held.size());
    freeBlocks_ = linalg::blocksFor(freeNodes_ + (model.dynamicTopology ? freeNodes_ / 4 : 0));
    nodeOf_.resize(static_cast<std::size_t>(freeBlocks_) * kBlock, -1);
    nodeOf_.insert(nodeOf_.end(), held.begin(), held.end());
    for (std::size_t slot = 0; slot < nodeOf_.size(); ++slot)
        if (nodeOf_[slot] >= 0) slotOf_[nodeOf_[slot]] = static_cast<int>(slot);

    const std::size_t slots = static_cast<std::size_t>(freeBlocks_) * kBlock;
    masses_.assign(slots, 1.0f);
    pins_.assign(slots, 0.0f);
    diagonal_.assign(slots, 0.0f);
    for (int slot = 0; slot < freeNodes_; ++slot) masses_[slot] = asFloat(scale_ * model.masses[nodeOf_[slot]]);
    for (const PinSpring& pin : model.pins.springs)
        if (!model.pins.hard[pin.node]) pins_[slotOf_[pin.node]] += asFloat(scale_ * pin.stiffness);

    makeVectors(linalg::blocksFor(heldNodes_));
}

void MatrixFreeSystem::makeVectors(int heldBlocks)
{
    for (NodeArray* array : {&x_, &v_, &dv_, &scratch_}) *array = NodeArray(freeBlocks_, heldBlocks);
    for (NodeArray* array : {&residual_, &product_, &handedOn_, &zeros_, &outer_}) *array = NodeArray(freeBlocks_);
    sums_.resize(static_cast<std::size_t>(linalg::nodeParts(freeBlocks_).count()));
    cg_ = linalg::MatrixFreeCg(freeBlocks_, heldBlocks);
}

void MatrixFreeSystem::makeElements(const SoftModel& model)
{
    elementCount_ = static_cast<int>(model.elements.size());
    const int blocks = linalg::blocksFor(elementCount_);
    elements_.resize(static_cast<std::size_t>(blocks));
    tangents_ = makeTangents(model.material.law, elements_.size());
    fibres_.resize(model.fibres.size() * elements_.size());
    fibreTangents_.resize(fibres_.size());
    inverted_.resize(elements_.size());
    strains_.resize(kBlock * elements_.size());
    quaternions_.resize(static_cast<std::size_t>(blocks));
    for (int lane = 0; lane < blocks * kBlock; ++lane) {
        const int source = std::min(lane, elementCount_ - 1);
        writeElement(model.elements[source], lane, lane < elementCount_);
        writeFibres(model, source, lane, lane < elementCount_);
    }
}

void MatrixFreeSystem::writeElement(const FemElement& e, int element, bool real)
{
    ElementBlock& block = elements_[element / kBlock];
    const int l = element % kBlock;
    for (int i = 0; i < 4; ++i) block.nodes[i][l] = 4 * slotOf_[e.nodes[i]];
    for (int k = 0; k < 9; ++k) block.gradients[k][l] = asFloat(e.gradients[1 + k / 3][k % 3]);
    const auto [mu, lambda] = lameOf(e);
    const double weight = real ? scale_ * e.volume : 0.0;
    block.mu[l] = asFloat(weight * mu);
    block.ratio[l] = asFloat(lambda / mu);
    stiffest_ = {std::max(stiffest_.mu, mu), std::max(stiffest_.lambda, std::abs(lambda))};
}

void MatrixFreeSystem::writeFibres(const SoftModel& model, int source, int element, bool real)
{
    const FemElement& e = model.elements[source];
    for (std::size_t family = 0; family < model.fibres.size(); ++family) {
        const Vec3 direction = model.fibres[family][source];
        const Mat3 h = structureTensor(model.material.fibres[family].dispersion, direction);
        FibreBlock& block = fibres_[family * elements_.size() + static_cast<std::size_t>(element / kBlock)];
        const int l = element % kBlock;
        for (std::size_t i = 1, k = 0; i < 4; ++i)
            for (std::size_t j = i; j < 4; ++j, ++k)
                block.structure[k][l] = asFloat(dot(e.gradients[i], h * e.gradients[j]));
        block.volume[l] = real && direction != Vec3{} ? asFloat(scale_ * e.volume) : 0.0f;
    }
}

void MatrixFreeSystem::makeSprings(const SoftModel& model)
{
    const int count = static_cast<int>(model.springs.size()), blocks = linalg::blocksFor(count);
    springs_.resize(static_cast<std::size_t>(blocks));
    springMatrices_.resize(static_cast<std::size_t>(blocks));
    for (int lane = 0; lane < blocks * kBlock; ++lane) {
        const Spring& s = model.springs[std::min(lane, count - 1)];
        SpringBlock& block = springs_[lane / kBlock];
        const int l = lane % kBlock;
        for (int i = 0; i < 2; ++i)
            block.nodes[i][l] = springMatrices_[lane / kBlock].nodes[i][l] = 4 * slotOf_[s.nodes[i]];
        const double weight = lane < count ? scale_ : 0.0;
        block.restLength[l] = asFloat(s.restLength);
        block.stiffness[l] = asFloat(weight * s.stiffness);
        block.damping[l] = asFloat(weight * s.damping);
    }
}

void MatrixFreeSystem::makeShell(const SoftModel& model)
{
    shell_ = ShellSystem(model.shell, model.rest, slotOf_, scale_, model.dynamicTopology);
    if (!shell_.empty()) quaternions_.resize(shell_.rotationGroups());
}

void MatrixFreeSystem::makeGather(const SoftModel& model)
{
    corners_.resize(4 * elements_.size() + 2 * springs_.size() + shell_.groups());
    std::vector<std::vector<int>> places(static_cast<std::size_t>(freeBlocks_) * kBlock);
    const auto add = [&](int node, std::size_t group, int lane) {
        if (const int slot = slotOf_[node]; slot < freeNodes_)
            places[slot].push_back(static_cast<int>(group) * 64 + linalg::laneOffset(lane));
    };
    for (std::size_t e = 0; e < model.elements.size(); ++e)
        for (std::size_t i = 0; i < 4; ++i)
            add(model.elements[e].nodes[i], 4 * (e / kBlock) + i, static_cast<int>(e % kBlock));
    // The mean rotation of a few elements around a node is nearly as good as that of all of them.
    if (!elements_.empty()) turns_ = linalg::Gather(thinned(places, kRotationsPerNode));
    for (std::size_t s = 0; s < model.springs.size(); ++s)
        for (std::size_t i = 0; i < 2; ++i)
            add(model.springs[s].nodes[i], 4 * elements_.size() + 2 * (s / kBlock) + i, static_cast<int>(s % kBlock));
    if (!shell_.empty()) { // a shell has neither elements nor springs
        std::vector<std::vector<int>> turns(places.size());
        const auto turn = [&](int node, std::size_t group, int lane) {
            if (const int slot = slotOf_[node]; slot < freeNodes_)
                turns[slot].push_back(static_cast<int>(4 * group) * 64 + linalg::laneOffset(lane));
        };
        shell_.forEachCorner(model.shell, add, turn);
        turns_ = linalg::Gather(thinned(turns, kRotationsPerNode));
    }
    gather_ = linalg::Gather(places);
}

void MatrixFreeSystem::makeVolumes(const SoftModel& model)
{
    const int slots = kBlock * (freeBlocks_ + x_.pinnedBlocks()); // with room for the nodes of edits
    volumes_ =
        model.nodalVolumes ? NodalVolumes(model, slotOf_, static_cast<std::size_t>(slots), scale_) : NodalVolumes();
}

} // namespace filasofia::engine
