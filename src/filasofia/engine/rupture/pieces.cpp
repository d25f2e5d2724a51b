#include "filasofia/engine/rupture/pieces.h"

#include <algorithm>

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

Pieces::Pieces(const MeshTopology& mesh)
{
    ids_ = connectedParts(mesh, count_);
    next_ = count_;
}

std::vector<DetachedPiece> Pieces::update(const MeshTopology& mesh)
{
    int parts = 0;
    const std::vector<int> part = connectedParts(mesh, parts);
    // A part's elements were all of one piece: a child's parent is in the same part, or was when it was made.
    std::vector<double> volume(parts, 0.0);
    std::vector<int> from(parts, -1);
    for (int t = 0; t < static_cast<int>(part.size()); ++t) {
        volume[part[t]] += restVolume(mesh, t);
        if (t < static_cast<int>(ids_.size()) && from[part[t]] < 0) from[part[t]] = ids_[t];
    }
    // A part of new elements alone is a piece of what its neighbours were; all came from one edit, so any piece will do
    // that lost them: the one that the record's parents name is not known here.
    std::vector<int> heir(next_, -1);
    for (int p = 0; p < parts; ++p)
        if (from[p] >= 0 && (heir[from[p]] < 0 || volume[p] > volume[heir[from[p]]])) heir[from[p]] = p;
    std::vector<int> id(parts);
    std::vector<DetachedPiece> detached;
    for (int p = 0; p < parts; ++p) {
        if (from[p] >= 0 && heir[from[p]] == p) {
            id[p] = from[p];
            continue;
        }
        id[p] = next_++;
        detached.push_back({id[p], std::max(from[p], 0), {}});
    }
    ids_.resize(part.size());
    std::vector<int> place(parts, -1);
    for (int i = 0, p = 0; p < parts; ++p)
        if (!(from[p] >= 0 && heir[from[p]] == p)) place[p] = i++;
    for (int t = 0; t < static_cast<int>(part.size()); ++t) {
        ids_[t] = id[part[t]];
        if (place[part[t]] >= 0) detached[place[part[t]]].tetrahedra.push_back(t);
    }
    count_ = parts;
    return detached;
}

} // namespace filasofia::engine
