#include "filasofia/engine/rupture/editable_mesh.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/sorted.h"
#include "filasofia/engine/rupture/tet_shape.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

using geometry::Tetrahedron;

void clear(std::uint8_t& mask, int face) { mask = static_cast<std::uint8_t>(mask & ~bit(face)); }
void set(std::uint8_t& mask, int face) { mask = static_cast<std::uint8_t>(mask | bit(face)); }

/// The formula of frame::followNodes(), bit for bit.
Vec3 between(Vec3 a, Vec3 b, double s) { return (1.0 - s) * a + s * b; }

} // namespace

void edgeStar(const MeshTopology& mesh, int a, int b, std::vector<int>& star)
{
    star.clear();
    const bool shorter = mesh.around[a].size() < mesh.around[b].size();
    for (int t : mesh.around[shorter ? a : b])
        if (placeOf(mesh.tetrahedra[t], shorter ? b : a) >= 0) star.push_back(t);
}

bool isBoundaryFace(const MeshTopology& mesh, int t, int face)
{
    return frame::isTriangle(mesh.tetrahedra[t]) ? face == 3 : mesh.neighbours[t][face] < 0;
}

double restQuality(const MeshTopology& mesh, int tetrahedron)
{
    const Tetrahedron& nodes = mesh.tetrahedra[tetrahedron];
    const std::array<Vec3, 4> p = solidCorners(nodes, mesh.rest);
    return afterMove(frame::isTriangle(nodes), p, 0, p[0]).quality;
}

double restVolume(const MeshTopology& mesh, int tetrahedron)
{
    return volumeOf(solidCorners(mesh.tetrahedra[tetrahedron], mesh.rest));
}

bool onBoundary(const MeshTopology& mesh, int node)
{
    return std::ranges::any_of(mesh.around[node], [&](int t) {
        const std::span<const int> nodes = nodesOf(mesh.tetrahedra[t]);
        for (std::size_t f = 0; f < nodes.size(); ++f)
            if (mesh.neighbours[t][f] < 0 && nodes[f] != node) return true;
        return false;
    });
}

bool onBoundary(const MeshTopology& mesh, int a, int b)
{
    return std::ranges::any_of(mesh.around[a], [&](int t) {
        const std::span<const int> n = nodesOf(mesh.tetrahedra[t]);
        if (std::ranges::find(n, b) == n.end()) return false;
        for (std::size_t f = 0; f < n.size(); ++f)
            if (mesh.neighbours[t][f] < 0 && n[f] != a && n[f] != b) return true;
        return false;
    });
}

void EditableMesh::moveTo(std::span<const Vec3> positions)
{
    FILASOFIA_ASSERT(positions.size() == data_.current.size());
    data_.previous.swap(data_.current);
    double farthest = 0.0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
        farthest = std::max(farthest, lengthSquared(positions[i] - data_.previous[i]));
        data_.current[i] = positions[i];
    }
    lastMotion_ = std::sqrt(farthest);
    ++moves_;
}

void EditableMesh::placeAt(std::span<const Vec3> positions)
{
    FILASOFIA_ASSERT(positions.size() == data_.current.size());
    data_.current.assign(positions.begin(), positions.end());
    data_.previous = data_.current;
    lastMotion_ = 0.0;
    moves_ += 2; // more than one step, so that callers that rely on small motions rebuild their data
}

int EditableMesh::addNode(Vec3 rest, Vec3 current, Vec3 previous)
{
    data_.rest.push_back(rest);
    data_.current.push_back(current);
    data_.previous.push_back(previous);
    data_.around.emplace_back();
    data_.labels.emplace_back();
    reach_.push_back(0.0);
    return nodes() - 1;
}

void EditableMesh::setMask(std::vector<std::uint8_t>& mask, int tetrahedron, int face, bool on)
{
    const int other = data_.neighbours[tetrahedron][face];
    if (other < 0) return;
    const int otherFace = faceTowards(other, tetrahedron);
    if (on) {
        set(mask[tetrahedron], face);
        set(mask[other], otherFace);
    } else {
        clear(mask[tetrahedron], face);
        clear(mask[other], otherFace);
    }
}

// Two elements share at most one face: with two they would have the same four nodes, and one of them no volume.
int EditableMesh::faceTowards(int tetrahedron, int other) const
{
    for (int f = 0; f < 4; ++f)
        if (data_.neighbours[tetrahedron][f] == other) return f;
    FILASOFIA_ASSERT(false);
    return -1;
}

double EditableMesh::qualityAfterBisecting(int a, int b, double s, const std::vector<int>& star) const
{
    const Vec3 middle = between(data_.rest[a], data_.rest[b], s);
    double worst = 1.0;
    for (int t : star) {
        const Tetrahedron& n = data_.tetrahedra[t];
        for (int end : {a, b}) {
            const std::array<Vec3, 4> p = solidCorners(n, data_.rest);
            worst = std::min(worst, afterMove(isSheet(), p, placeOf(n, end), middle).quality);
        }
    }
    return worst;
}

int EditableMesh::bisect(int a, int b, double s)
{
    FILASOFIA_ASSERT(splits_.empty() && s > 0.0 && s < 1.0);
    edgeStar(data_, a, b, star_);
    FILASOFIA_ASSERT(!star_.empty());
    const int middle = addNode(between(data_.rest[a], data_.rest[b], s), between(data_.current[a], data_.current[b], s),
                               between(data_.previous[a], data_.previous[b], s));
    ops_.emplace_back(frame::NewNode{middle, a, b, s});
    const int first = tetrahedra();
    const auto childOf = [&](int t) { // across the faces around the edge the children are neighbours
        for (std::size_t i = 0; i < star_.size(); ++i)
            if (star_[i] == t) return first + static_cast<int>(i);
        return -1;
    };
    for (int t : star_) {
        data_.tetrahedra.push_back(Tetrahedron(data_.tetrahedra[t]));
        data_.neighbours.push_back(std::array<int, 4>(data_.neighbours[t]));
        data_.flagged.push_back(std::uint8_t(data_.flagged[t]));
        data_.deferred.push_back(std::uint8_t(data_.deferred[t]));
        data_.opened.push_back(std::uint8_t(data_.opened[t]));
        data_.gone.push_back(0);
        data_.sides[t] = 0; // undecided for both: the sheet may run between them
        data_.sides.push_back(0);
    }
    for (std::size_t i = 0; i < star_.size(); ++i) {
        const int parent = star_[i], child = first + static_cast<int>(i);
        const int ia = placeOf(data_.tetrahedra[parent], a), ib = placeOf(data_.tetrahedra[parent], b);
        Tetrahedron& corners = data_.tetrahedra[child];
        std::array<int, 4>& beside = data_.neighbours[child];
        for (int k = 0; k < 4; ++k) {
            if (k == ia || k == ib || corners[k] == frame::kNoCorner) continue;
            if (beside[k] >= 0) beside[k] = childOf(beside[k]);
            data_.around[corners[k]].push_back(child);
            reach_[middle] = std::max(reach_[middle], distance(data_.rest[middle], data_.rest[corners[k]]));
        }
        // The face without a goes to the child, the one without b stays; the new face lies between the two.
        if (beside[ia] >= 0) data_.neighbours[beside[ia]][faceTowards(beside[ia], parent)] = child;
        corners[ia] = middle;
        data_.tetrahedra[parent][ib] = middle;
        beside[ib] = parent;
        data_.neighbours[parent][ia] = child;
        for (std::vector<std::uint8_t>* mask : {&data_.flagged, &data_.deferred, &data_.opened}) {
            clear((*mask)[child], ib);
            clear((*mask)[parent], ia);
        }
        *std::ranges::find(data_.around[b], parent) = child;
        data_.around[middle].push_back(parent);
        data_.around[middle].push_back(child);
        dirty_.push_back(parent);
        dirty_.push_back(child);
        ops_.emplace_back(frame::TetSplit{parent, child, ia, ib, middle, s});
    }
    // The reach of the other nodes still holds: their new edges are no longer than the longer of two that they had.
    reach_[middle] = std::max(
        {reach_[middle], distance(data_.rest[middle], data_.rest[a]), distance(data_.rest[middle], data_.rest[b])});
    return middle;
}

void EditableMesh::slide(int node, int toward, double s)
{
    const Vec3 old = data_.rest[node];
    for (std::vector<Vec3>* x : {&data_.rest, &data_.current, &data_.previous})
        (*x)[node] = between((*x)[node], (*x)[toward], s);
    ops_.emplace_back(frame::NodeMove{node, toward, s, old, data_.rest[node]});
    const double way = distance(old, data_.rest[node]);
    for (int t : data_.around[node]) {
        dirty_.push_back(t);
        for (int n : nodesOf(data_.tetrahedra[t]))
            if (n != node) reach_[n] = std::max(reach_[n], distance(data_.rest[n], data_.rest[node]));
    }
    reach_[node] += way;
}

int EditableMesh::split(int node)
{
    const std::vector<int>& star = data_.around[node];
    const int count = static_cast<int>(star.size());
    const auto placeInStar = [&](int t) {
        for (int i = 0; i < count; ++i)
            if (star[i] == t) return i;
        return -1;
    };
    group_.assign(count, -1);
    int groups = 0;
    for (int i = 0; i < count; ++i) {
        if (group_[i] >= 0) continue;
        group_[i] = groups;
        stack_ = {i};
        while (!stack_.empty()) {
            const int at = stack_.back(), t = star[at];
            stack_.pop_back();
            for (int f = 0; f < 4; ++f) {
                if (data_.tetrahedra[t][f] == node || data_.neighbours[t][f] < 0 || has(data_.flagged[t], f)) continue;
                const int beside = placeInStar(data_.neighbours[t][f]);
                if (group_[beside] >= 0) continue;
                group_[beside] = groups;
                stack_.push_back(beside);
            }
        }
        ++groups;
    }
    if (groups == 1) return 0;

    for (int i = 0; i < count; ++i) // faces between groups
        for (int f = 0; f < 4; ++f) {
            const int t = star[i], other = data_.neighbours[t][f];
            const int beside = other < 0 ? -1 : placeInStar(other);
            if (beside < 0 || group_[beside] == group_[i]) continue;
            const int otherFace = faceTowards(other, t);
            data_.neighbours[t][f] = data_.neighbours[other][otherFace] = -1;
            openedFaces_.push_back({t, f, other, otherFace});
        }
    splits_.push_back({node, groups - 1, std::move(data_.around[node])});
    const std::vector<int>& old = splits_.back().around; // `star` is empty now
    data_.around[node].clear();
    const int origin = originOf(node);
    for (int g = 1; g < groups; ++g) {
        const int copy = addNode(data_.rest[node], data_.current[node], data_.previous[node]);
        data_.labels[copy] = data_.labels[node];
        reach_[copy] = reach_[node];
        copies_.push_back({copy, node, origin});
    }
    for (int i = 0; i < count; ++i) {
        const int t = old[i], now = group_[i] == 0 ? node : nodes() - groups + group_[i];
        data_.tetrahedra[t][placeOf(data_.tetrahedra[t], node)] = now;
        data_.around[now].push_back(t);
    }
    return groups - 1;
}

int EditableMesh::originOf(int node) const
{
    const int before = nodes() - static_cast<int>(copies_.size());
    return node < before ? node : copies_[node - before].origin;
}

void EditableMesh::commit()
{
    for (const Copy& copy : copies_) {
        ops_.emplace_back(frame::NodeCopy{copy.from, copy.copy});
        for (int t : data_.around[copy.copy])
            ops_.emplace_back(frame::TetCorner{t, placeOf(data_.tetrahedra[t], copy.copy), copy.copy});
        dirty_.insert(dirty_.end(), data_.around[copy.copy].begin(), data_.around[copy.copy].end());
    }
    for (const OpenedFace& face : openedFaces_)
        for (auto [t, f] : {std::pair(face.tetrahedron, face.face), std::pair(face.other, face.otherFace)}) {
            clear(data_.flagged[t], f);
            clear(data_.deferred[t], f);
            set(data_.opened[t], f);
            dirty_.push_back(t);
        }
    splits_.clear();
    copies_.clear();
    openedFaces_.clear();
}

void EditableMesh::rollBack()
{
    for (const OpenedFace& face : openedFaces_) {
        data_.neighbours[face.tetrahedron][face.face] = face.other;
        data_.neighbours[face.other][face.otherFace] = face.tetrahedron;
    }
    while (!splits_.empty()) {
        SplitUndo& undo = splits_.back();
        for (int i = 0; i < undo.count; ++i) {
            const int copy = nodes() - 1;
            for (int t : data_.around[copy]) data_.tetrahedra[t][placeOf(data_.tetrahedra[t], copy)] = undo.node;
            data_.rest.pop_back();
            data_.current.pop_back();
            data_.previous.pop_back();
            data_.around.pop_back();
            data_.labels.pop_back();
            reach_.pop_back();
        }
        data_.around[undo.node] = std::move(undo.around);
        splits_.pop_back();
    }
    copies_.clear();
    openedFaces_.clear();
}

void EditableMesh::publish(int t, frame::TopologyEdit& edit)
{
    using Kind = frame::BoundaryChange::Kind;
    const Tetrahedron& now = data_.tetrahedra[t];
    const bool fresh = t >= static_cast<int>(published_.size());
    if (fresh) {
        published_.push_back({-1, -1, -1, -1});
        publishedBoundary_.push_back(0);
    }
    const Tetrahedron before = published_[t];
    edit.changed.push_back({t, now});
    for (int f = 0; f < 4; ++f) {
        const bool was = has(publishedBoundary_[t], f), is = isBoundaryFace(data_, t, f);
        if (!was && !is) continue;
        const geometry::Triangle old = was ? faceNodes(before, f) : geometry::Triangle{}, nodes = faceNodes(now, f);
        const bool opened = has(data_.opened[t], f);
        if (was && is && old == nodes) continue;
        if (was && is) edit.boundary.push_back({Kind::Changed, t, f, nodes, opened});
        if (was && !is) edit.boundary.push_back({Kind::Removed, t, f, old, opened});
        if (!was && is) edit.boundary.push_back({Kind::Added, t, f, nodes, opened});
        if (is)
            set(publishedBoundary_[t], f);
        else
            clear(publishedBoundary_[t], f);
    }
    published_[t] = now;
}

double EditableMesh::faceArea(int tetrahedron, int face) const
{
    const Tetrahedron& t = data_.tetrahedra[tetrahedron];
    const auto at = [&](int corner) { return data_.rest[t[corner]]; };
    if (isSheet()) return thickness_ * distance(at((face + 1) % 3), at((face + 2) % 3));
    const auto [a, b, c] = faceNodes(t, face);
    return 0.5 * length(cross(data_.rest[b] - data_.rest[a], data_.rest[c] - data_.rest[a]));
}

void EditableMesh::remove(std::span<const int> tetrahedra)
{
    for (int t : tetrahedra) {
        data_.gone[t] = 1;
        data_.flagged[t] = data_.deferred[t] = 0; // a whole piece, so this clears both sides of every face
    }
}

frame::TopologyEdit EditableMesh::takeEdit(BodyId body)
{
    FILASOFIA_ASSERT(splits_.empty());
    frame::TopologyEdit edit{.body = body, .nodes = nodes(), .tetrahedra = tetrahedra()};
    if (!edited()) return edit;
    edit.revision = ++revision_;
    edit.ops.swap(ops_);
    sortUnique(dirty_);
    for (int t : dirty_) publish(t, edit);
    dirty_.clear();
    return edit;
}

} // namespace filasofia::engine
