#include "filasofia/engine/collision/edit_shape.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/geometry/surface.h"

#include "engine/collision/scene.h"

#include <map>
#include <set>

namespace filasofia::engine::edit_test {
namespace {

/// A solid that loses tetrahedra, with the edits of its surface.
class ErodingSolid {
public:
    explicit ErodingSolid(int cells)
        : mesh_(*geometry::shapes::block({0.05, 0.05, 0.05}, {cells, cells, cells})), there_(mesh_.tetrahedra.size(), 1)
    {
        const geometry::Surface surface = geometry::extractSurface(mesh_);
        surface_ = surface.mesh;
        vertexOf_.assign(mesh_.nodes.size(), -1);
        for (std::size_t v = 0; v < surface.nodes.size(); ++v) {
            vertexOf_[surface.nodes[v]] = static_cast<int>(v);
            nodeOf_.push_back(surface.nodes[v]);
        }
        for (std::size_t t = 0; t < mesh_.tetrahedra.size(); ++t)
            for (std::size_t f = 0; f < 4; ++f) beside_[key(face(t, f))].push_back(t);
    }

    [[nodiscard]] const geometry::TriangleMesh& surface() const { return surface_; }

    /// Removes up to `count` connected tetrahedra, at least one of them at the surface.
    SurfaceEdit erode(int count, std::mt19937& random)
    {
        std::uniform_int_distribution<std::size_t> any(0, surface_.triangles.size() - 1);
        geometry::Triangle start = surface_.triangles[any(random)];
        for (int& v : start) v = nodeOf_[v];
        std::set<std::size_t> gone;
        for (const std::size_t t : beside_.at(key(start)))
            if (there_[t]) gone.insert(t);
        for (int round = 0; round < 8 && static_cast<int>(gone.size()) < count; ++round)
            for (const std::size_t t : std::vector<std::size_t>(gone.begin(), gone.end()))
                for (std::size_t f = 0; f < 4; ++f)
                    for (const std::size_t other : beside_.at(key(face(t, f))))
                        if (there_[other] && static_cast<int>(gone.size()) < count) gone.insert(other);
        return take(gone);
    }

    /// Two triangles over one edge become two over the other diagonal. If they lie in one plane the body keeps its
    /// shape.
    SurfaceEdit flip(const CollisionShape& shape, std::mt19937& random)
    {
        for (int attempt = 0; attempt < 1000; ++attempt) {
            const int e = std::uniform_int_distribution<int>(0, static_cast<int>(shape.edges.size()) - 1)(random);
            if (shape.edgeTriangles[e].size() != 2) continue;
            const int s = shape.edgeTriangles[e][0], t = shape.edgeTriangles[e][1];
            const auto [a, b] = shape.edges[e];
            const int c = shape.edgeOpposites[shape.edgeTriangles.start[e]],
                      d = shape.edgeOpposites[shape.edgeTriangles.start[e] + 1];
            if (c == d || std::ranges::binary_search(shape.edges, std::array{std::min(c, d), std::max(c, d)})) continue;
            const geometry::Triangle& first = shape.triangles[s];
            const bool along = (first[0] == a && first[1] == b) || (first[1] == a && first[2] == b) ||
                               (first[2] == a && first[0] == b);
            SurfaceEdit edit;
            edit.changed = {{s, along ? geometry::Triangle{a, d, c} : geometry::Triangle{b, d, c}},
                            {t, along ? geometry::Triangle{d, b, c} : geometry::Triangle{d, a, c}}};
            for (const auto& [triangle, corners] : edit.changed) surface_.triangles[triangle] = corners;
            return edit;
        }
        FAIL("no edge to flip");
        return {};
    }

private:
    using Key = std::array<int, 3>;
    static Key key(geometry::Triangle t)
    {
        std::ranges::sort(t);
        return t;
    }
    [[nodiscard]] geometry::Triangle face(std::size_t t, std::size_t f) const
    {
        const auto& corners = geometry::kTetrahedronFaces[f];
        return {mesh_.tetrahedra[t][corners[0]], mesh_.tetrahedra[t][corners[1]], mesh_.tetrahedra[t][corners[2]]};
    }

    SurfaceEdit take(const std::set<std::size_t>& gone)
    {
        SurfaceEdit edit;
        for (const std::size_t t : gone) there_[t] = 0;
        std::set<Key> lost;
        for (const std::size_t t : gone)
            for (std::size_t f = 0; f < 4; ++f) {
                const geometry::Triangle outside = face(t, f);
                const std::vector<std::size_t>& two = beside_.at(key(outside));
                const bool still = std::ranges::any_of(two, [&](std::size_t each) { return there_[each] != 0; });
                if (!still) lost.insert(key(outside));
                if (!still) continue;
                geometry::Triangle inside{outside[0], outside[2], outside[1]};
                for (int& node : inside) {
                    if (vertexOf_[node] < 0) {
                        vertexOf_[node] = static_cast<int>(surface_.vertices.size());
                        nodeOf_.push_back(node);
                        edit.vertices.push_back(mesh_.nodes[node]);
                        surface_.vertices.push_back(mesh_.nodes[node]);
                    }
                    node = vertexOf_[node];
                }
                edit.added.push_back(inside);
            }
        std::vector<geometry::Triangle> left;
        for (std::size_t i = 0; i < surface_.triangles.size(); ++i) {
            geometry::Triangle nodes = surface_.triangles[i];
            for (int& v : nodes) v = nodeOf_[v];
            if (lost.contains(key(nodes)))
                edit.removed.push_back(static_cast<int>(i));
            else
                left.push_back(surface_.triangles[i]);
        }
        left.insert(left.end(), edit.added.begin(), edit.added.end());
        surface_.triangles = left;
        return edit;
    }

    geometry::TetMesh mesh_;
    std::vector<char> there_;
    geometry::TriangleMesh surface_;
    std::vector<int> vertexOf_, nodeOf_;
    std::map<Key, std::vector<std::size_t>> beside_;
};

void checkSame(const CollisionShape& edited, const CollisionShape& whole)
{
    REQUIRE(edited.rest == whole.rest);
    REQUIRE(edited.triangles == whole.triangles);
    REQUIRE(edited.edges == whole.edges);
    REQUIRE(edited.edgeOpposites == whole.edgeOpposites);
    for (const auto rows :
         {&CollisionShape::edgeTriangles, &CollisionShape::vertexEdges, &CollisionShape::vertexTriangles}) {
        REQUIRE((edited.*rows).start == (whole.*rows).start);
        REQUIRE((edited.*rows).items == (whole.*rows).items);
    }
    REQUIRE(edited.closed == whole.closed);
    REQUIRE(edited.elements.size() == whole.elements.size());
}

/// Every triangle is in one leaf, every node has one place in the tree, and every vertex and edge has one owner.
void checkTree(const CollisionShape& shape)
{
    std::vector<int> seen(shape.triangles.size()), vertices(shape.rest.size()), edges(shape.edges.size());
    std::vector<int> open{0};
    std::size_t nodes = 0, elements = 0;
    while (!open.empty()) {
        const int at = open.back();
        open.pop_back();
        ++nodes;
        const CollisionShape::Node& node = shape.nodes.at(at);
        if (node.count == 0) {
            REQUIRE(node.first > at + 1);
            open.push_back(at + 1);
            open.push_back(node.first);
        }
        elements += static_cast<std::size_t>(node.count);
        for (int i = node.first; i < node.first + node.count; ++i) {
            const CollisionShape::Element& element = shape.elements.at(i);
            ++seen.at(element.triangle);
            REQUIRE(element.vertices == shape.triangles[element.triangle]);
            for (const int v : element.ownVertices)
                if (v >= 0) ++vertices.at(v);
            for (const int e : element.ownEdges)
                if (e >= 0) ++edges.at(e);
        }
    }
    REQUIRE(nodes == shape.nodes.size());
    REQUIRE(elements == shape.elements.size());
    const auto once = [](int count) { return count == 1; };
    REQUIRE(std::ranges::all_of(seen, once));
    REQUIRE(std::ranges::all_of(edges, once));
    for (std::size_t v = 0; v < vertices.size(); ++v)
        REQUIRE(vertices[v] == (shape.vertexTriangles[static_cast<int>(v)].empty() ? 0 : 1));
}

} // namespace

TEST_CASE("a shape edited two hundred times equals the shape built from the result, and so does its inset")
{
    std::mt19937 random(5);
    for (const int cells : {5, 9}) {
        ErodingSolid solid(cells);
        const double depth = 1e-3;
        CollisionShape shape = makeCollisionShape(solid.surface(), {});
        Inset inset = makeInset(shape, depth);
        for (int i = 0; i < 100; ++i) {
            const SurfaceEdit edit = i < 60 ? solid.erode(cells == 5 ? 3 : 10, random) : solid.flip(shape, random);
            ShapeChange change;
            const CollisionShape now = editShape(shape, edit, change);
            inset = editInset(inset, shape, now, change, depth);
            const CollisionShape whole = makeCollisionShape(solid.surface(), {});
            checkSame(now, whole);
            checkTree(now);
            const Inset asked = makeInset(whole, depth);
            REQUIRE(inset.depth == asked.depth);
            REQUIRE(inset.share == asked.share);
            for (std::size_t e = 0; e < shape.edges.size(); ++e) {
                const bool still = std::ranges::binary_search(now.edges, shape.edges[e]);
                REQUIRE((change.edges[e] >= 0) == still);
                if (still) REQUIRE(now.edges[change.edges[e]] == shape.edges[e]);
            }
            shape = now;
        }
        CHECK(shape.closed);
    }
}

TEST_CASE("queries on an edited shape match queries on a rebuilt one")
{
    std::mt19937 random(7);
    ErodingSolid solid(7);
    const CollisionOptions options{.proximity = 1e-3, .depth = 2e-3};
    CollisionShape shape = makeCollisionShape(solid.surface(), options);
    std::size_t met = 0;
    for (int i = 0; i < 60; ++i) {
        ShapeChange change;
        shape = editShape(shape, solid.erode(5, random), change);
        const Pose pose{randomVector(random, 0.03), axisAngle(randomVector(random, 1.0), 1.0)};
        const geometry::TriangleMesh lump = lumpMesh(0.02, 7, 0.1, random);
        std::array<std::map<std::uint64_t, Proximity>, 2> found;
        for (const bool edited : {true, false}) {
            Scene scene;
            scene.add(solid.surface(), options);
            if (edited) scene.surfaces[0].shape = std::make_shared<const CollisionShape>(shape);
            scene.add(lump, options, pose);
            for (const Proximity& each : scene.find()) found[edited ? 0 : 1][each.feature] = each;
        }
        REQUIRE(found[0].size() == found[1].size());
        met += found[0].size();
        for (const auto& [feature, each] : found[0]) {
            const auto other = found[1].find(feature);
            REQUIRE(other != found[1].end());
            REQUIRE(each.gap == other->second.gap);
            REQUIRE(each.normal == other->second.normal);
            REQUIRE(each.vertices == other->second.vertices);
        }
    }
    CHECK(met > 1000);
}

TEST_CASE("the opposite wall of a cut does not reduce the inset")
{
    // Two boxes whose walls touch, as after a cut, form one surface.
    geometry::TriangleMesh mesh = boxMesh({0.01, 0.01, 0.01}, 3);
    const int count = static_cast<int>(mesh.vertices.size());
    for (int v = 0; v < count; ++v)
        mesh.vertices.push_back(mesh.vertices[static_cast<std::size_t>(v)] + Vec3{0.02, 0, 0});
    for (std::size_t t = 0, all = mesh.triangles.size(); t < all; ++t) {
        const auto [a, b, c] = mesh.triangles[t];
        mesh.triangles.push_back({a + count, b + count, c + count});
    }
    const Inset inset = makeInset(makeCollisionShape(mesh, {}), 1e-4);
    for (const double depth : inset.depth) CHECK(depth == Approx(1e-4));
}

} // namespace filasofia::engine::edit_test
