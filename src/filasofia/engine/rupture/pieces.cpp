#include "filasofia/engine/rupture/pieces.h"

#include <algorithm>
#include <tuple>

namespace filasofia::engine {

std::vector<int> connectedParts(const MeshTopology& mesh, int& count)
{
    std::vector<int> part(mesh.tetrahedra.size(), -1), stack;
    count = 0;
    for (int first = 0; first < static_cast<int>(part.size()); ++first) {
        if (part[first] >= 0) continue;
        part[first] = count;
        stack = {first};
        while (!stack.empty()) {
            const int t = stack.back();
            stack.pop_back();
            for (int other : mesh.neighbours[t]) {
                if (other < 0 || part[other] >= 0) continue;
                part[other] = count;
                stack.push_back(other);
            }
        }
        ++count;
    }
    return part;
}

namespace {

/// The elements at faces that an edit opened. For a sheet, all that it changed, if it opened any edge.
std::vector<int> besideOpened(const MeshTopology& mesh, const frame::TopologyEdit& edit)
{
    std::vector<int> elements;
    if (frame::isTriangle(mesh.tetrahedra.front())) {
        const auto isCopy = [](const frame::TopologyOp& op) { return std::holds_alternative<frame::NodeCopy>(op); };
        if (!std::ranges::any_of(edit.ops, isCopy)) return elements;
        for (const frame::TetNodes& each : edit.changed) elements.push_back(each.tetrahedron);
        return elements;
    }
    // A Changed face counts too: a face that became interior when its element was bisected may open in the same edit.
    for (const frame::BoundaryChange& change : edit.boundary)
        if (change.opened && change.kind != frame::BoundaryChange::Kind::Removed)
            elements.push_back(change.tetrahedron);
    return elements;
}

} // namespace

Pieces::Pieces(const MeshTopology& mesh)
{
    ids_ = connectedParts(mesh, count_);
    next_ = count_;
}

std::vector<DetachedPiece> Pieces::update(const MeshTopology& mesh, const frame::TopologyEdit& edit)
{
    follow(edit);
    return fallsApart(mesh, edit) ? divide(mesh) : std::vector<DetachedPiece>{};
}

std::vector<DetachedPiece> Pieces::walk(const MeshTopology& mesh, const frame::TopologyEdit& edit)
{
    follow(edit);
    return divide(mesh);
}

void Pieces::follow(const frame::TopologyEdit& edit)
{
    for (const frame::TopologyOp& op : edit.ops)
        if (const auto* split = std::get_if<frame::TetSplit>(&op)) ids_.push_back(ids_[split->parent]);
}

// Runs one breadth-first search from each element at an opened face, all at the same pace. Two searches that touch are
// merged. A search that has no elements left has covered a whole part: its piece fell apart, unless that was the
// piece's only search.
bool Pieces::fallsApart(const MeshTopology& mesh, const frame::TopologyEdit& edit)
{
    search_.resize(ids_.size(), -1);
    // Per search: the search that it was merged into, and its number of elements not yet visited. Per piece: its
    // searches.
    std::vector<int> parent, waiting, searchesLeft;
    const auto rootOf = [&](int search) {
        while (parent[search] != search) search = parent[search] = parent[parent[search]];
        return search;
    };
    reached_.clear();
    for (int element : besideOpened(mesh, edit)) {
        if (search_[element] >= 0) continue;
        search_[element] = static_cast<int>(parent.size());
        parent.push_back(static_cast<int>(parent.size()));
        waiting.push_back(1);
        reached_.push_back(element);
        searchesLeft.resize(std::max<std::size_t>(searchesLeft.size(), ids_[element] + 1), 0);
        ++searchesLeft[ids_[element]];
    }
    auto apart = static_cast<int>(std::ranges::count_if(searchesLeft, [](int searches) { return searches > 1; }));
    bool found = false;
    for (std::size_t next = 0; next < reached_.size() && apart > 0 && !found; ++next) {
        const int t = reached_[next], piece = ids_[t];
        int search = rootOf(search_[t]);
        for (int other : mesh.neighbours[t]) {
            if (other < 0) continue;
            if (search_[other] < 0) {
                search_[other] = search;
                reached_.push_back(other);
                ++waiting[search];
                continue;
            }
            const int touched = rootOf(search_[other]);
            if (touched == search) continue;
            parent[touched] = search;
            waiting[search] += waiting[touched];
            if (--searchesLeft[piece] == 1) --apart;
        }
        found = --waiting[search] == 0 && searchesLeft[piece] > 1;
    }
    for (int t : reached_) search_[t] = -1;
    return found;
}

std::vector<DetachedPiece> Pieces::divide(const MeshTopology& mesh)
{
    int parts = 0;
    const std::vector<int> part = connectedParts(mesh, parts);
    std::vector<double> volume(parts, 0.0);
    std::vector<int> from(parts, -1); // the piece that the part belonged to
    for (int t = 0; t < static_cast<int>(part.size()); ++t) {
        volume[part[t]] += restVolume(mesh, t);
        from[part[t]] = ids_[t];
    }
    std::vector<int> heir(next_, -1);
    for (int p = 0; p < parts; ++p)
        if (heir[from[p]] < 0 || volume[p] > volume[heir[from[p]]]) heir[from[p]] = p;
    std::vector<int> id(parts);
    std::vector<DetachedPiece> detached;
    for (int p = 0; p < parts; ++p) {
        if (heir[from[p]] == p) {
            id[p] = from[p];
            continue;
        }
        id[p] = next_++;
        detached.push_back({id[p], from[p], {}});
    }
    std::vector<int> place(parts, -1);
    for (int i = 0, p = 0; p < parts; ++p)
        if (heir[from[p]] != p) place[p] = i++;
    for (int t = 0; t < static_cast<int>(part.size()); ++t) {
        ids_[t] = id[part[t]];
        if (place[part[t]] >= 0) detached[place[part[t]]].tetrahedra.push_back(t);
    }
    count_ = parts;
    return detached;
}

std::vector<int> piecesBeyond(double far, std::span<const PiecePlace> pieces)
{
    std::vector<std::tuple<bool, std::size_t, int>> beyond; // is the body itself, node count, number
    for (const PiecePlace& piece : pieces)
        if (distance(piece.now, piece.rest) > far) beyond.emplace_back(piece.number == 0, piece.nodes, piece.number);
    std::ranges::sort(beyond);
    if (!beyond.empty() && beyond.size() == pieces.size()) beyond.pop_back();
    std::vector<int> numbers;
    for (const auto& [itself, nodes, number] : beyond) numbers.push_back(number);
    return numbers;
}

} // namespace filasofia::engine
