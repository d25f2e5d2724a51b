#include "filasofia/engine/rupture/open_faces.h"

#include "filasofia/core/sorted.h"
#include "filasofia/engine/rupture/manifold.h"
#include "filasofia/engine/rupture/tet_shape.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace filasofia::engine {
namespace {

using Edge = std::array<int, 2>;

/// [-] A cut with so many labels for each face that is left is as good as complete. A strip narrower than two elements
/// never is: with slits as they are made at the end of such a cut, 891 mm^2 opened where 160 mm^2 were swept.
constexpr std::ptrdiff_t kFewLeft = 10;

/// Rounds after which each of the gentler repairs is given up.
constexpr int kBisectRounds = 20, kFlipRounds = 25, kLoopRounds = 30;

/// A node that is not manifold after the splits, by node numbers before the transaction.
struct BadVertex {
    int node;
    std::vector<int> loop;                ///< the other nodes of the loop that encloses the cut; empty: no such loop
    std::vector<int> cone;                ///< the elements inside it, if they are few and have a node of their own
    std::vector<std::array<int, 2>> slit; ///< faces from one loop to the other, on both sides of the node
};

/// The label of the new node is between those of the two.
int bisectInMiddle(EditableMesh& mesh, int a, int b)
{
    const CutLabel la = mesh.data().labels[a], lb = mesh.data().labels[b];
    CutLabel label;
    if (la.sheet != 0 && lb.sheet != 0)
        label = {std::min(la.sheet, lb.sheet),    std::max(la.sequence, lb.sequence),
                 0.5 * (la.point + lb.point),     normalized(la.normal + lb.normal),
                 normalized(la.facet + lb.facet), la.sequence > lb.sequence ? la.swept : lb.swept};
    const int middle = mesh.bisect(a, b, 0.5);
    mesh.setLabel(middle, label);
    return middle;
}

class Opening {
public:
    Opening(EditableMesh& mesh, const OpeningLimits& limits, RuptureReport& report)
        : mesh_(mesh), data_(mesh.data()), limits_(limits), report_(report)
    {
    }

    void open(std::vector<int> candidates, bool alone = false)
    {
        ++report_.edits;
        candidates_ = std::move(candidates);
        sortUnique(candidates_);
        if (!alone) retryDeferred();
        for (int round = 0;; ++round) {
            for (int node : candidates_) mesh_.split(node);
            findFaults();
            if (badEdges_.empty() && badVertices_.empty()) break;
            if (round == 0) ++report_.repairedEdits;
            ++report_.repairRounds;
            mesh_.rollBack();
            if (round >= limits_.rounds) {
                giveUp();
                return;
            }
            for (const Edge& edge : badEdges_) repair(edge, round);
            if (round < kFlipRounds) flipCones();
            for (const BadVertex& bad : badVertices_)
                if ((bad.cone.empty() || round >= kFlipRounds) && !joinLoops(bad)) retract(bad, round);
            sortUnique(candidates_);
        }
        addToReport();
        mesh_.commit();
    }

private:
    void addNodesOf(int t, int face)
    {
        for (int k = 0; k < 4; ++k)
            if (k != face) candidates_.push_back(data_.tetrahedra[t][k]);
    }

    void defer(int t, int face)
    {
        mesh_.setFlagged(t, face, false);
        mesh_.setDeferred(t, face, true);
        ++report_.repairDeferred;
    }

    void retryDeferred()
    {
        const std::size_t count = candidates_.size();
        for (std::size_t i = 0; i < count; ++i)
            for (int t : data_.around[candidates_[i]])
                for (int f = 0; f < 4 && data_.deferred[t] != 0; ++f) {
                    if (!has(data_.deferred[t], f)) continue;
                    mesh_.setDeferred(t, f, false);
                    mesh_.setFlagged(t, f, true);
                    addNodesOf(t, f);
                }
        sortUnique(candidates_);
    }

    void findFaults()
    {
        badEdges_.clear();
        badVertices_.clear();
        edges_.clear();
        vertices_.clear();
        openedSides_.clear();
        if (mesh_.isSheet()) return; // each group of triangles at a node is one fan: a split leaves a manifold
        for (const EditableMesh::OpenedFace& face : mesh_.openedFaces())
            for (auto [t, f] : {std::pair(face.tetrahedron, face.face), std::pair(face.other, face.otherFace)}) {
                openedSides_.push_back({t, f});
                const std::array<int, 3> n = faceNodes(data_.tetrahedra[t], f);
                for (int k = 0; k < 3; ++k) {
                    vertices_.push_back(n[k]);
                    const int a = n[k], b = n[(k + 1) % 3];
                    edges_.push_back({std::min(a, b), std::max(a, b)});
                }
            }
        sortUnique(openedSides_);
        sortUnique(edges_);
        sortUnique(vertices_);
        for (const Edge& e : edges_)
            if (!isOneFan(data_, e[0], e[1])) {
                const int a = mesh_.originOf(e[0]), b = mesh_.originOf(e[1]);
                badEdges_.push_back({std::min(a, b), std::max(a, b)});
            }
        sortUnique(badEdges_);
        // Loops are meaningful only if every edge is a single fan.
        if (!badEdges_.empty()) return;
        for (int v : vertices_) {
            const std::vector<FaceLoop> loops = boundaryLoops(data_, v);
            if (loops.size() > 1) badVertices_.push_back(describe(v, loops));
        }
    }

    /// Finds the smallest loop that only this transaction created, and the elements inside it.
    [[nodiscard]] BadVertex describe(int v, const std::vector<FaceLoop>& loops) const
    {
        BadVertex bad{mesh_.originOf(v), {}, {}, {}};
        if (limits_.slit && loops.size() == 2) bad.slit = slitBetween(v, loops);
        const FaceLoop* best = nullptr;
        for (const FaceLoop& loop : loops) {
            const bool pure = std::ranges::all_of(
                loop, [&](const auto& side) { return std::ranges::binary_search(openedSides_, side); });
            if (pure && (!best || loop.size() < best->size())) best = &loop;
        }
        if (!best) return bad;
        for (auto [t, f] : *best)
            for (int n : faceNodes(data_.tetrahedra[t], f))
                if (n != v) bad.loop.push_back(mesh_.originOf(n));
        sortUnique(bad.loop);
        // If all faces of the loop have the same node across them, its elements are the cone.
        int tip = -1;
        for (auto [t, f] : *best) {
            const int other = acrossOpened(t, f);
            int there = -1;
            for (int n : data_.tetrahedra[other])
                if (mesh_.originOf(n) == bad.node) there = n;
            if (tip >= 0 && there != tip) return bad;
            tip = there;
        }
        // A cone flips only once: otherwise it could flip back and forth.
        const bool again = std::ranges::find(flippedAt_, bad.node) != flippedAt_.end();
        if (!again && tip >= 0 && tip != v && static_cast<int>(data_.around[tip].size()) <= limits_.cone &&
            boundaryLoops(data_, tip).size() == 1)
            bad.cone = data_.around[tip];
        return bad;
    }

    /// The faces at v that a plane through the centres of its two loops separates. If they open too, the node becomes
    /// two, each with one loop.
    [[nodiscard]] std::vector<std::array<int, 2>> slitBetween(int v, const std::vector<FaceLoop>& loops) const
    {
        std::array<Vec3, 2> middles;
        for (int i = 0; i < 2; ++i)
            for (auto [t, f] : loops[i])
                for (int n : faceNodes(data_.tetrahedra[t], f)) middles[i] += data_.rest[n] - data_.rest[v];
        const Vec3 a = normalized(middles[0]), b = normalized(middles[1]);
        const Vec3 across =
            normalized(cross(a, b), normalized(cross(a, std::abs(a.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})));
        const auto ahead = [&](int t) {
            const std::array<Vec3, 4> p = cornersOf(data_.tetrahedra[t], data_.rest);
            return dot(across, 0.25 * (p[0] + p[1] + p[2] + p[3]) - data_.rest[v]) >= 0.0;
        };
        std::vector<std::array<int, 2>> slit;
        for (int t : data_.around[v])
            for (int f = 0; f < 4; ++f)
                if (data_.tetrahedra[t][f] != v && data_.neighbours[t][f] > t &&
                    ahead(t) != ahead(data_.neighbours[t][f]))
                    slit.push_back({t, f});
        return slit;
    }

    [[nodiscard]] int acrossOpened(int t, int f) const
    {
        for (const EditableMesh::OpenedFace& face : mesh_.openedFaces()) {
            if (face.tetrahedron == t && face.face == f) return face.other;
            if (face.other == t && face.otherFace == f) return face.tetrahedron;
        }
        return -1;
    }

    /// A slit that ends in one edge pinches it. A node at the edge's midpoint lets the slit open there; without one it
    /// stays closed.
    void repair(const Edge& edge, int round)
    {
        const auto [a, b] = edge;
        edgeStar(data_, a, b, star_);
        const double l = distance(data_.rest[a], data_.rest[b]);
        if (limits_.bisect && round < kBisectRounds && l > limits_.shortestEdge &&
            mesh_.qualityAfterBisecting(a, b, 0.5, star_) >= limits_.minQuality) {
            candidates_.push_back(bisectInMiddle(mesh_, a, b));
            ++report_.repairBisections;
            return;
        }
        for (int t : star_)
            for (int f = 0; f < 4; ++f)
                if (has(data_.flagged[t], f) && data_.tetrahedra[t][f] != a && data_.tetrahedra[t][f] != b) defer(t, f);
    }

    void flipCones()
    {
        flipping_.clear();
        for (const BadVertex& bad : badVertices_) {
            const bool apart = std::ranges::none_of(
                bad.cone, [&](int t) { return std::ranges::find(flipping_, t) != flipping_.end(); });
            if (bad.cone.empty() || !apart) continue;
            ++report_.repairFlips;
            flippedAt_.push_back(bad.node);
            flipping_.insert(flipping_.end(), bad.cone.begin(), bad.cone.end());
        }
        std::ranges::sort(flipping_);
        for (int t : flipping_) {
            if (data_.sides[t] != 0) mesh_.setSide(t, data_.sides[t] ^ 1);
            for (int f = 0; f < 4; ++f) {
                const int other = data_.neighbours[t][f];
                if (other < 0 || std::ranges::binary_search(flipping_, other)) continue;
                mesh_.setFlagged(t, f, !has(data_.flagged[t], f));
                addNodesOf(t, f);
            }
        }
    }

    /// If two loops touch in a node, a slit between them joins them into one. Each node gets at most one slit; later
    /// faults there are repaired by the other means.
    bool joinLoops(const BadVertex& bad)
    {
        if (bad.slit.empty() || std::ranges::find(slitAt_, bad.node) != slitAt_.end()) return false;
        slitAt_.push_back(bad.node);
        ++report_.repairSlits;
        for (auto [t, f] : bad.slit) {
            mesh_.setFlagged(t, f, true);
            addNodesOf(t, f);
        }
        return true;
    }

    /// If two loops touch in a node, one of them stays closed there, or both do.
    void retract(const BadVertex& bad, int round)
    {
        const auto deferAt = [&](bool loopOnly) {
            bool any = false;
            for (int t : data_.around[bad.node])
                for (int f = 0; f < 4; ++f) {
                    if (!has(data_.flagged[t], f) || data_.tetrahedra[t][f] == bad.node) continue;
                    const auto n = faceNodes(data_.tetrahedra[t], f);
                    const auto inLoop = std::ranges::count_if(
                        n, [&](int k) { return k != bad.node && std::ranges::binary_search(bad.loop, k); });
                    if (loopOnly && inLoop < 2) continue;
                    defer(t, f);
                    any = true;
                }
            return any;
        };
        if (bad.loop.empty() || round >= kLoopRounds || !deferAt(true)) deferAt(false);
    }

    void giveUp()
    {
        ++report_.givenUp;
        for (int node : candidates_)
            for (int t : data_.around[node])
                for (int f = 0; f < 4; ++f)
                    if (data_.tetrahedra[t][f] != node) mesh_.setFlagged(t, f, false);
    }

    void addToReport()
    {
        report_.openedFaces += static_cast<long>(mesh_.openedFaces().size());
        report_.copies += static_cast<long>(mesh_.copies().size());
        for (const EditableMesh::OpenedFace& face : mesh_.openedFaces()) {
            const double area = mesh_.faceArea(face.tetrahedron, face.face);
            report_.openedArea += area;
            if (mesh_.isSheet()) {
                forEachFaceNode(data_.tetrahedra[face.tetrahedron], face.face,
                                [&](int n) { report_.openedMoment += 0.5 * area * data_.current[n]; });
                continue;
            }
            const auto [a, b, c] = faceNodes(data_.tetrahedra[face.tetrahedron], face.face);
            report_.openedMoment += (area / 3.0) * (data_.current[a] + data_.current[b] + data_.current[c]);
        }
    }

    EditableMesh& mesh_;
    const MeshTopology& data_;
    const OpeningLimits& limits_;
    RuptureReport& report_;
    std::vector<int> candidates_, vertices_, star_, flipping_;
    std::vector<Edge> edges_, badEdges_;
    std::vector<std::array<int, 2>> openedSides_;
    std::vector<BadVertex> badVertices_;
    std::vector<int> slitAt_;    ///< nodes whose loops were joined in this transaction
    std::vector<int> flippedAt_; ///< nodes whose cones changed side in this transaction
};

/// Calls look(element, face) for each face that a cut has passed and that has not opened.
template <class Look> void forEachClosed(const EditableMesh& mesh, const Look& look)
{
    const MeshTopology& data = mesh.data();
    for (int t = 0; t < mesh.tetrahedra(); ++t)
        for (int f = 0; f < 4; ++f)
            if (has(static_cast<std::uint8_t>(data.flagged[t] | data.deferred[t]), f) && data.neighbours[t][f] > t)
                look(t, f);
}

bool isOf(int sheet, int t, int face, const MeshTopology& data)
{
    bool all = true;
    forEachFaceNode(data.tetrahedra[t], face, [&](int n) { all = all && data.labels[n].sheet == sheet; });
    return all;
}

/// Whether few faces of a cut are left, which may then take slits with them.
bool isAlmostDone(const EditableMesh& mesh, int sheet)
{
    const MeshTopology& data = mesh.data();
    std::ptrdiff_t left = 0;
    forEachClosed(mesh, [&](int t, int f) { left += isOf(sheet, t, f, data) ? 1 : 0; });
    return kFewLeft * left <= std::ranges::count(data.labels, sheet, &CutLabel::sheet);
}

/// Where a cut is narrow, its closed faces have all nodes on its rim, and nothing parts these: a strip that a blade of
/// less than about two elements passed stays whole. A node in the middle of an edge of two such faces opens both.
/// Returns these new nodes.
std::vector<int> partStuckFaces(EditableMesh& mesh, int sheet, const OpeningLimits& limits, RuptureReport& report)
{
    if (mesh.isSheet()) return {};
    const MeshTopology& data = mesh.data();
    struct EdgeOfFace {
        double length; // [m]
        Edge edge;
        int face;
    };
    std::vector<EdgeOfFace> edges;
    int faces = 0;
    forEachClosed(mesh, [&](int t, int f) {
        if (!isOf(sheet, t, f, data)) return;
        const std::array<int, 3> n = faceNodes(data.tetrahedra[t], f);
        for (int k = 0; k < 3; ++k) {
            const Edge edge = {std::min(n[k], n[(k + 1) % 3]), std::max(n[k], n[(k + 1) % 3])};
            edges.push_back({distance(data.rest[edge[0]], data.rest[edge[1]]), edge, faces});
        }
        ++faces;
    });
    // Long edges first, as where a blade crosses them.
    std::ranges::sort(edges, [](const EdgeOfFace& x, const EdgeOfFace& y) {
        if (x.length != y.length) return x.length > y.length;
        return std::tie(x.edge, x.face) < std::tie(y.edge, y.face);
    });
    std::vector<bool> parted(static_cast<std::size_t>(faces));
    std::vector<int> made, star;
    for (std::size_t i = 0, next = 0; i < edges.size(); i = next) {
        while (next < edges.size() && edges[next].edge == edges[i].edge) ++next;
        const auto [a, b] = edges[i].edge;
        if (next - i != 2 || edges[i].length <= limits.shortestEdge || parted[edges[i].face] ||
            parted[edges[i + 1].face])
            continue;
        edgeStar(data, a, b, star);
        if (mesh.qualityAfterBisecting(a, b, 0.5, star) < limits.minQuality) continue;
        parted[edges[i].face] = parted[edges[i + 1].face] = true;
        made.push_back(bisectInMiddle(mesh, a, b));
        ++report.repairBisections;
    }
    return made;
}

} // namespace

void openFaces(EditableMesh& mesh, const OpeningLimits& limits, std::vector<int> candidates, RuptureReport& report)
{
    if (candidates.empty()) return;
    Opening(mesh, limits, report).open(std::move(candidates));
}

void openAll(EditableMesh& mesh, int sheet, const OpeningLimits& limits, RuptureReport& report)
{
    const MeshTopology& data = mesh.data();
    std::vector<int> candidates;
    forEachClosed(
        mesh, [&](int t, int f) { forEachFaceNode(data.tetrahedra[t], f, [&](int n) { candidates.push_back(n); }); });
    openFaces(mesh, limits, std::move(candidates), report);
    const bool almost = isAlmostDone(mesh, sheet);
    if (!almost) openFaces(mesh, limits, partStuckFaces(mesh, sheet, limits, report), report);
    // Faces can block each other, so try them one at a time as long as another one opens.
    OpeningLimits last = limits;
    for (bool progress = true; progress;) {
        progress = false;
        for (int t = 0; t < mesh.tetrahedra(); ++t)
            for (int f = 0; f < 4; ++f) {
                if (!has(data.deferred[t], f) || data.neighbours[t][f] < t) continue;
                const auto n = faceNodes(data.tetrahedra[t], f);
                mesh.setDeferred(t, f, false);
                mesh.setFlagged(t, f, true);
                last.slit = almost && isOf(sheet, t, f, data);
                const long before = report.openedFaces;
                Opening(mesh, last, report).open({n.begin(), n.end()}, true);
                progress = progress || report.openedFaces > before;
            }
    }
}

} // namespace filasofia::engine
