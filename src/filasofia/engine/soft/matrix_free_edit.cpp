// Updates a MatrixFreeSystem after an edit of its body's mesh, only where the edit has changed the mesh.
#include "filasofia/engine/soft/matrix_free_system.h"

#include "filasofia/core/sorted.h"
#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/body/tissue.h"
#include "filasofia/engine/soft/coarse_rebuild.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

/// The element (with `corners` nodes) to whose corner an entry of the gather list points.
int elementAt(int place, int corners)
{
    const int offset = place % 64, lane = offset / kBlock + 4 * (offset % kBlock / 4);
    return place / (64 * corners) * kBlock + lane;
}

/// The interpolation of a node between two others: the weighted sum of theirs. If that has more than four coarse nodes,
/// the four with the largest weights are kept.
linalg::Interpolation interpolateBetween(const linalg::Interpolation& a, const linalg::Interpolation& b, double share)
{
    struct Part {
        int corner;
        double weight;
    };
    std::vector<Part> parts;
    const auto add = [&](const linalg::Interpolation& from, double weight) {
        for (std::size_t k = 0; k < 4; ++k) {
            if (from.weights[k] == 0.0f) continue;
            const auto known = std::ranges::find(parts, from.corners[k], &Part::corner);
            if (known != parts.end())
                known->weight += weight * from.weights[k];
            else
                parts.push_back({from.corners[k], weight * from.weights[k]});
        }
    };
    add(a, 1.0 - share);
    add(b, share);
    std::ranges::stable_sort(parts, std::ranges::greater{}, &Part::weight);
    double all = 0.0, kept = 0.0;
    for (std::size_t k = 0; k < parts.size(); ++k) {
        all += parts[k].weight;
        if (k < 4) kept += parts[k].weight;
    }
    linalg::Interpolation how;
    for (std::size_t k = 0; k < std::min<std::size_t>(parts.size(), 4); ++k) {
        how.corners[k] = parts[k].corner;
        how.weights[k] = static_cast<float>(parts[k].weight * all / kept);
    }
    return how;
}

/// Resizes each of `count` lists that follow one another.
template <class Block> void resizeLists(std::vector<Block>& lists, std::size_t count, std::size_t size)
{
    if (lists.size() == count * size) return;
    std::vector<Block> out(count * size);
    const std::size_t before = lists.size() / count;
    for (std::size_t k = 0; k < count; ++k)
        std::copy_n(lists.begin() + static_cast<std::ptrdiff_t>(k * before), std::min(before, size),
                    out.begin() + static_cast<std::ptrdiff_t>(k * size));
    lists = std::move(out);
}

} // namespace

bool MatrixFreeSystem::edit(const SoftModel& model, const MeshEdit& edit)
{
    heldListed_ = false;
    const bool grown = reserve(model, edit);
    const bool sharing = model.nodalVolumes && !volumes_.empty() && !grown;
    if (!sharing) volumes_ = {}; // made anew below, as slots have moved
    const int known = static_cast<int>(slotOf_.size());
    for (std::size_t i = 0; i < edit.nodes.size(); ++i) addNode(model, known + static_cast<int>(i), edit.nodes[i]);
    if (rebuild_) rebuild_->add(edit.nodes);
    parted_ = parted_ || std::ranges::any_of(edit.nodes, [](const auto& each) { return each.first == each.second; });
    if (!shell_.empty()) {
        editShell(model, edit, grown);
    } else if (model.elements.empty()) { // springs have much less data than elements: rebuild them
        makeSprings(model);
        makeGather(model);
    } else {
        for (int element : edit.elements) moveElement(model, element);
    }
    if (sharing)
        for (int node : edit.reached) volumes_.refresh(slotOf_[static_cast<std::size_t>(node)]);
    else
        makeVolumes(model);
    for (int node : edit.reached)
        if (const int slot = slotOf_[static_cast<std::size_t>(node)]; slot < freeNodes_) refreshNode(model, slot);
    return grown;
}

bool MatrixFreeSystem::reserve(const SoftModel& model, const MeshEdit& edit)
{
    const std::size_t blocks = static_cast<std::size_t>(linalg::blocksFor(static_cast<int>(model.elements.size())));
    elements_.resize(blocks);
    std::visit([&](auto& each) { each.resize(blocks); }, tangents_);
    inverted_.resize(blocks);
    strains_.resize(kBlock * blocks);
    resizeLists(fibres_, model.fibres.size(), blocks);
    resizeLists(fibreTangents_, model.fibres.size(), blocks);
    if (shell_.empty()) {
        quaternions_.resize(blocks);
        corners_.resize(4 * blocks);
    }
    if (!volumes_.empty()) volumes_.resize(blocks);

    int free = 0, held = 0;
    for (std::size_t i = slotOf_.size(); i < slotOf_.size() + edit.nodes.size(); ++i)
        ++(model.pins.hard[i] ? held : free);
    const int heldRoom = kBlock * x_.pinnedBlocks() - heldNodes_;
    if (freeNodes_ + free <= kBlock * freeBlocks_ && held <= heldRoom) return false;

    // Make room: the pinned nodes move back.
    const int more = linalg::blocksFor(std::max(free, freeNodes_ / 4));
    const int heldBlocks = linalg::blocksFor(std::max(heldNodes_ + held, heldNodes_ + heldNodes_ / 4));
    const int oldEnd = kBlock * freeBlocks_, shift = kBlock * more;
    nodeOf_.insert(nodeOf_.begin() + oldEnd, static_cast<std::size_t>(shift), -1);
    for (int& slot : slotOf_)
        if (slot >= oldEnd) slot += shift;
    const auto moveBack = [&](auto& nodes) {
        for (auto& corner : nodes)
            for (int& node : corner)
                if (node >= 4 * oldEnd) node += 4 * shift;
    };
    for (ElementBlock& block : elements_) moveBack(block.nodes);
    freeBlocks_ += more;
    makeVectors(heldBlocks);
    const auto slots = static_cast<std::size_t>(kBlock) * static_cast<std::size_t>(freeBlocks_);
    masses_.resize(slots, 1.0f);
    pins_.resize(slots, 0.0f);
    diagonal_.resize(slots, 0.0f);
    gather_.resize(slots);
    turns_.resize(slots);
    if (preconditioned_) preconditioner_.grow(freeBlocks_);
    return true;
}

void MatrixFreeSystem::editShell(const SoftModel& model, const MeshEdit& edit, bool grown)
{
    if (grown || !shell_.hasRoomFor(model.shell)) {
        makeShell(model);
        makeGather(model);
        return;
    }
    shell_.edit(model.shell, model.rest, slotOf_, edit.elements, {gather_, turns_, kRotationsPerNode, freeNodes_});
    corners_.resize(shell_.groups());
}

void MatrixFreeSystem::addNode(const SoftModel& model, int node, const MeshEdit::Node& made)
{
    if (model.pins.hard[static_cast<std::size_t>(node)]) {
        slotOf_.push_back(kBlock * freeBlocks_ + heldNodes_++);
        nodeOf_.push_back(node);
        return;
    }
    const int slot = freeNodes_++;
    slotOf_.push_back(slot);
    nodeOf_[static_cast<std::size_t>(slot)] = node;
    if (preconditioned_) interpolate(slot, made);
}

void MatrixFreeSystem::interpolate(int slot, const MeshEdit::Node& made)
{
    const auto followed = [&](int parent) { // a pinned node has no interpolation
        const int at = slotOf_[static_cast<std::size_t>(parent)];
        return at < freeNodes_ ? preconditioner_.interpolation(at) : linalg::Interpolation{};
    };
    preconditioner_.interpolate(
        slot, made.first == made.second ? followed(made.first)
                                        : interpolateBetween(followed(made.first), followed(made.second), made.share));
}

void MatrixFreeSystem::followParting(const SoftModel& model, BackgroundThread& meanwhile)
{
    if (!preconditioned_) return;
    if (rebuild_ && rebuild_->isDue()) {
        const bool taken = preconditioner_.takeCoarseLevel(rebuild_->take());
        preconditioner_.setClusters(rebuild_->takeClusters());
        if (taken) tied_ = false;
        // Nodes added meanwhile interpolate from their parents; if the old coarse level stays, they do so already.
        const std::vector<MeshEdit::Node>& since = rebuild_->since();
        for (std::size_t i = 0; taken && i < since.size(); ++i)
            if (const int slot = slotOf_[slotOf_.size() - since.size() + i]; slot < freeNodes_)
                interpolate(slot, since[i]);
        rebuild_.reset();
    }
    if (rebuild_ || !parted_) return;
    parted_ = false;
    rebuild_ = std::make_unique<CoarseRebuild>(model, plan(), meanwhile);
}

void MatrixFreeSystem::moveElement(const SoftModel& model, int element)
{
    const int block = element / kBlock, lane = element % kBlock;
    const FemElement& now = model.elements[static_cast<std::size_t>(element)];
    const bool isNew = element >= elementCount_;
    elementCount_ = std::max(elementCount_, element + 1);
    for (int i = 0; i < 4; ++i) {
        const int place = (4 * block + i) * 64 + linalg::laneOffset(lane);
        const int before = isNew ? -1 : elements_[static_cast<std::size_t>(block)].nodes[i][lane] / 4;
        const int after = slotOf_[static_cast<std::size_t>(now.nodes[static_cast<std::size_t>(i)])];
        if (before == after) continue;
        if (!volumes_.empty()) volumes_.moveCorner(element, before, after);
        if (before >= 0 && before < freeNodes_) {
            const auto list = static_cast<std::size_t>(before);
            gather_.remove(list, place);
            if (turns_.contains(list, place)) turns_.remove(list, place);
            if (turns_.size(list) == 0 && gather_.size(list) > 0) turns_.add(list, *gather_.begin(list));
        }
        if (after < freeNodes_) {
            const auto list = static_cast<std::size_t>(after);
            gather_.add(list, place);
            if (turns_.size(list) < kRotationsPerNode) turns_.add(list, place);
        }
    }
    writeElement(now, element, true);
    writeFibres(model, element, element, true);
    if (!volumes_.empty()) volumes_.setShare(now, element);
    for (int filler = element + 1; isNew && filler % kBlock != 0; ++filler) {
        writeElement(now, filler, false);
        writeFibres(model, element, filler, false);
    }
}

bool MatrixFreeSystem::editTissue(const SoftModel& model, const std::vector<int>& elements)
{
    if (!fits(model, period_)) return false;
    MeshEdit changed{.nodes = {}, .elements = elements, .reached = {}};
    for (int e : elements)
        for (int node : model.elements[static_cast<std::size_t>(e)].nodes) changed.reached.push_back(node);
    sortUnique(changed.reached);
    edit(model, changed);
    parted_ = true; // the coarse level is that of the former tissue
    return true;
}

void MatrixFreeSystem::refreshNode(const SoftModel& model, int slot)
{
    const int node = nodeOf_[static_cast<std::size_t>(slot)];
    const double mass = model.masses[static_cast<std::size_t>(node)];
    masses_[static_cast<std::size_t>(slot)] = static_cast<float>(scale_ * mass);
    if (!preconditioned_) return;
    const ImplicitWeights weights = implicitWeights(period_, {model.rayleigh.mass, model.rayleigh.stiffness},
                                                    relaxationTangent(model.material.relaxation, period_));
    Mat3 diagonal =
        (scale_ * weights.mass * mass + weights.stiffness * pins_[static_cast<std::size_t>(slot)]) * Mat3::identity();
    const auto list = static_cast<std::size_t>(slot);
    if (!shell_.empty()) {
        diagonal += shell_.diagonalAtRest(model.shell, model.rest, weights, {gather_.begin(list), gather_.end(list)});
        preconditioner_.setDiagonal(slot, diagonal);
        return;
    }
    for (const int* place = gather_.begin(list); place != gather_.end(list); ++place) {
        if (model.elements.empty()) {
            const Spring& spring = model.springs[static_cast<std::size_t>(elementAt(*place, 2))];
            diagonal += scale_ * springMatrix(spring, weights, model.rest);
            continue;
        }
        const auto e = static_cast<std::size_t>(elementAt(*place, 4));
        const int corner = *place / 64 % 4;
        const Vec3 g = model.elements[e].gradients[static_cast<std::size_t>(corner)];
        diagonal += scale_ * model.elements[e].volume * blockAtRest(model, e, weights, g, g);
    }
    if (!volumes_.empty()) diagonal += weights.stiffness * volumes_.diagonalAtRest(model, node, slotOf_);
    preconditioner_.setDiagonal(slot, diagonal);
}

} // namespace filasofia::engine
