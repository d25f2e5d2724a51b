#include "filasofia/engine/collision/edit_shape.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/sorted.h"
#include "filasofia/engine/collision/shape_parts.h"

#include <algorithm>
#include <numeric>

namespace filasofia::engine {
namespace {

constexpr int kLargestLeaf = 8; // elements; a larger leaf is split

void checkEdit(const CollisionShape& before, const SurfaceEdit& edit)
{
    const int count = static_cast<int>(before.triangles.size());
    const int vertices = static_cast<int>(before.rest.size() + edit.vertices.size());
    const auto isTriangle = [&](int t) { return t >= 0 && t < count; };
    const auto isNew = [&](const geometry::Triangle& t) {
        return std::ranges::all_of(t, [&](int v) { return v >= 0 && v < vertices; });
    };
    FILASOFIA_ASSERT(std::ranges::is_sorted(edit.removed) && std::ranges::all_of(edit.removed, isTriangle));
    FILASOFIA_ASSERT(std::ranges::is_sorted(edit.changed, {}, &std::pair<int, geometry::Triangle>::first));
    for (const auto& [t, corners] : edit.changed) FILASOFIA_ASSERT(isTriangle(t) && isNew(corners));
    FILASOFIA_ASSERT(std::ranges::all_of(edit.added, isNew));
}

/// Builds the new list of triangles, and the map from old to new indices.
void editTriangles(const CollisionShape& before, const SurfaceEdit& edit, CollisionShape& now, ShapeChange& change)
{
    now.triangles = before.triangles;
    std::vector<char> fresh(before.triangles.size());
    const auto touch = [&](const CollisionShape& shape, int t) {
        change.box = merged(change.box, boxOf(shape, t));
        change.touched.insert(change.touched.end(), shape.triangles[t].begin(), shape.triangles[t].end());
    };
    for (const auto& [t, corners] : edit.changed) {
        touch(before, t);
        now.triangles[t] = corners;
        fresh[t] = 1;
    }
    change.triangles.resize(before.triangles.size());
    std::size_t kept = 0;
    for (std::size_t t = 0, gone = 0; t < before.triangles.size(); ++t) {
        if (gone < edit.removed.size() && edit.removed[gone] == static_cast<int>(t)) {
            ++gone;
            change.triangles[t] = -1;
            touch(before, static_cast<int>(t));
            continue;
        }
        change.triangles[t] = static_cast<int>(kept);
        if (fresh[t] != 0) change.fresh.push_back(static_cast<int>(kept));
        now.triangles[kept++] = now.triangles[t];
    }
    now.triangles.resize(kept);
    for (const geometry::Triangle& each : edit.added) {
        change.fresh.push_back(static_cast<int>(now.triangles.size()));
        now.triangles.push_back(each);
    }
    for (const int t : change.fresh) touch(now, t);
    sortUnique(change.touched);
}

/// The uses of edges, ascending. Those of the unchanged triangles are in order already.
std::vector<EdgeUse> editUses(const CollisionShape& before, const SurfaceEdit& edit, const CollisionShape& now,
                              const ShapeChange& change)
{
    std::vector<int> unchanged = change.triangles;
    for (const auto& each : edit.changed) unchanged[each.first] = -1;
    std::vector<EdgeUse> old;
    old.reserve(before.edgeTriangles.items.size() + before.edges.size());
    for (int e = 0; e < static_cast<int>(before.edges.size()); ++e) {
        if (before.edgeTriangles[e].empty()) old.push_back({before.edges[e]}); // a line
        for (const int t : before.edgeTriangles[e])
            if (unchanged[t] >= 0) old.push_back({before.edges[e], unchanged[t]});
    }
    std::vector<EdgeUse> fresh;
    for (const int t : change.fresh)
        for (int k = 0; k < 3; ++k) fresh.push_back({ordered(now.triangles[t][k], now.triangles[t][(k + 1) % 3]), t});
    std::ranges::sort(fresh);
    std::vector<EdgeUse> uses;
    uses.reserve(old.size() + fresh.size());
    auto from = old.begin();
    for (const EdgeUse& use : fresh) { // few: whole runs of old uses lie between them
        const auto to = std::lower_bound(from, old.end(), use);
        uses.insert(uses.end(), from, to);
        uses.push_back(use);
        from = to;
    }
    uses.insert(uses.end(), from, old.end());
    return uses;
}

/// Maps old edges to new ones. Both lists ascend.
std::vector<int> edgesNow(const CollisionShape& before, const CollisionShape& now)
{
    const auto key = [](std::array<int, 2> edge) { // one comparison instead of two
        return std::int64_t{edge[0]} << 32 | std::int64_t{edge[1]};
    };
    std::vector<int> edges(before.edges.size(), -1);
    std::size_t at = 0;
    for (std::size_t e = 0; e < before.edges.size(); ++e) {
        const std::int64_t wanted = key(before.edges[e]);
        while (at < now.edges.size() && key(now.edges[at]) < wanted) ++at;
        if (at < now.edges.size() && key(now.edges[at]) == wanted) edges[e] = static_cast<int>(at);
    }
    return edges;
}

/// Writes the old tree again, with the new elements in its leaves.
class Grafting {
public:
    Grafting(const CollisionShape& before, const ShapeChange& change, CollisionShape& now)
        : before_(before), change_(change), now_(now)
    {
    }

    /// Returns false if a new element has no neighbour in the old tree: then there is no place for it.
    bool graft()
    {
        if (!chooseLeaves()) return false;
        now_.elements.reserve(before_.elements.size() + newElements_.size());
        now_.nodes.reserve(before_.nodes.size() + 2 * newElements_.size());
        write(0);
        return !now_.nodes.empty();
    }

private:
    struct NewElement {
        int leaf, triangle;
        friend constexpr auto operator<=>(const NewElement&, const NewElement&) = default;
    };

    /// A new element goes to the leaf of a triangle around one of its vertices.
    bool chooseLeaves()
    {
        std::vector<int> leaf(now_.triangles.size(), -1); // per new triangle
        for (std::size_t n = 0; n < before_.nodes.size(); ++n)
            for (int i = 0; i < before_.nodes[n].count; ++i) {
                const int t = before_.elements[static_cast<std::size_t>(before_.nodes[n].first + i)].triangle;
                if (t >= 0 && change_.triangles[t] >= 0) leaf[change_.triangles[t]] = static_cast<int>(n);
            }
        std::vector<int> open;
        for (const int t : change_.fresh)
            if (leaf[t] < 0) open.push_back(t);
        while (!open.empty()) {
            const std::size_t left = open.size();
            std::erase_if(open, [&](int t) {
                for (const int vertex : now_.triangles[t])
                    for (const int beside : now_.vertexTriangles[vertex])
                        if (leaf[t] < 0) leaf[t] = leaf[beside];
                if (leaf[t] >= 0) newElements_.push_back({leaf[t], t});
                return leaf[t] >= 0;
            });
            if (open.size() == left) return false;
        }
        std::ranges::sort(newElements_);
        return true;
    }

    /// Returns false if nothing is left below this node.
    bool write(int at)
    {
        const CollisionShape::Node& node = before_.nodes[at];
        if (node.count > 0) return writeLeaf(at, node);
        const std::size_t self = now_.nodes.size();
        now_.nodes.emplace_back();
        const bool left = write(at + 1);
        const int second = static_cast<int>(now_.nodes.size());
        const bool right = write(node.first);
        if (left && right) {
            now_.nodes[self] = {second, 0};
            return true;
        }
        // The only child, or none, takes its parent's place: the nodes behind it move up by one.
        now_.nodes.erase(now_.nodes.begin() + static_cast<std::ptrdiff_t>(self));
        for (std::size_t n = self; n < now_.nodes.size(); ++n)
            if (now_.nodes[n].count == 0) --now_.nodes[n].first;
        return left || right;
    }

    bool writeLeaf(int at, const CollisionShape::Node& node)
    {
        const int first = static_cast<int>(now_.elements.size());
        for (int i = node.first; i < node.first + node.count; ++i) {
            CollisionShape::Element element = before_.elements[static_cast<std::size_t>(i)];
            if (element.triangle >= 0) {
                element.triangle = change_.triangles[element.triangle];
                if (element.triangle < 0) continue;
                element.vertices = now_.triangles[element.triangle];
            }
            now_.elements.push_back(element);
        }
        for (auto it = std::ranges::lower_bound(newElements_, NewElement{at, 0});
             it != newElements_.end() && it->leaf == at; ++it)
            now_.elements.push_back({.vertices = now_.triangles[it->triangle], .triangle = it->triangle});
        const int count = static_cast<int>(now_.elements.size()) - first;
        if (count > kLargestLeaf)
            split(first);
        else if (count > 0)
            now_.nodes.push_back({first, count});
        return count > 0;
    }

    /// Splits the elements from `first` on into new leaves.
    void split(int first)
    {
        const std::vector<CollisionShape::Element> all(now_.elements.begin() + first, now_.elements.end());
        std::vector<Vec3> middles;
        for (const CollisionShape::Element& each : all) middles.push_back(middleOf(now_, each));
        std::vector<int> order(all.size());
        std::iota(order.begin(), order.end(), 0);
        plant(middles, order, first, now_.nodes);
        for (std::size_t i = 0; i < order.size(); ++i)
            now_.elements[static_cast<std::size_t>(first) + i] = all[order[i]];
    }

    const CollisionShape& before_;
    const ShapeChange& change_;
    CollisionShape& now_;
    std::vector<NewElement> newElements_; ///< ascending
};

} // namespace

CollisionShape editShape(const CollisionShape& before, const SurfaceEdit& edit, ShapeChange& change)
{
    checkEdit(before, edit);
    change = {};
    CollisionShape now;
    now.rest.reserve(before.rest.size() + edit.vertices.size());
    now.rest = before.rest;
    now.rest.insert(now.rest.end(), edit.vertices.begin(), edit.vertices.end());
    now.points = before.points;
    now.lines = before.lines;
    now.triangleFaces = before.triangleFaces;
    now.proximity = before.proximity;
    now.ownProximity = before.ownProximity;
    now.depth = before.depth;
    now.sheet = before.sheet;
    now.group = before.group;
    now.self = before.self;
    now.cutting = before.cutting;
    editTriangles(before, edit, now, change);
    now.triangleFaces = now.triangleFaces && !now.triangles.empty();
    connect(editUses(before, edit, now, change), now);
    change.edges = edgesNow(before, now);
    now.grafted = before.grafted + static_cast<int>(change.fresh.size());
    const bool stale = 2 * static_cast<std::size_t>(now.grafted) > now.triangles.size();
    if (stale || !Grafting(before, change, now).graft()) plantTree(now);
    shareOut(now);
    return now;
}

} // namespace filasofia::engine
