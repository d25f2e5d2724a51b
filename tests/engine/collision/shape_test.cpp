#include "engine/collision/scene.h"

namespace filasofia::engine::shape_test {

TEST_CASE("a shape lists each edge once with its neighbouring triangles, and knows whether it is closed")
{
    const CollisionShape box = makeCollisionShape(boxMesh({1, 1, 1}, 2), {});
    CHECK(box.rest.size() == 26);
    CHECK(box.triangles.size() == 48);
    CHECK(box.edges.size() == 72);
    CHECK(box.closed);
    CHECK(std::ranges::is_sorted(box.edges));
    for (int e = 0; e < 72; ++e) {
        REQUIRE(box.edgeTriangles[e].size() == 2);
        for (int i = 0; i < 2; ++i) {
            const geometry::Triangle& t = box.triangles[box.edgeTriangles[e][i]];
            const int opposite = box.edgeOpposites[box.edgeTriangles.start[e] + i];
            std::array<int, 3> corners{box.edges[e][0], box.edges[e][1], opposite}, same = t;
            std::ranges::sort(corners), std::ranges::sort(same);
            CHECK(corners == same);
        }
    }
    const CollisionShape sheet = makeCollisionShape(sheetMesh(1, 3), {});
    CHECK(!sheet.closed);
    geometry::TriangleMesh turned = boxMesh({1, 1, 1});
    std::swap(turned.triangles[0][0], turned.triangles[0][1]);
    CHECK(!makeCollisionShape(turned, {}).closed);
}

TEST_CASE("a shape that never deforms knows its flat edges, and those of others may bend")
{
    const CollisionShape box = makeCollisionShape(boxMesh({1, 1, 1}, 2), {.rigid = true});
    int flat = 0;
    for (int e = 0; e < static_cast<int>(box.edges.size()); ++e) {
        const Vec3 a = box.rest[box.edges[e][0]], b = box.rest[box.edges[e][1]];
        const auto onSide = [&](double Vec3::*axis) { return a.*axis == b.*axis && std::abs(a.*axis) == 1.0; };
        const auto onRim = [&](double Vec3::*one, double Vec3::*two) { return onSide(one) && onSide(two); };
        CHECK(box.flat(e) != (onRim(&Vec3::x, &Vec3::y) || onRim(&Vec3::y, &Vec3::z) || onRim(&Vec3::z, &Vec3::x)));
        flat += box.flat(e) ? 1 : 0;
    }
    CHECK(flat == 72 - 24);
    CHECK(makeCollisionShape(boxMesh({1, 1, 1}, 2), {}).flatEdges.empty());
    const CollisionShape sheet = makeCollisionShape(sheetMesh(1, 3), {.rigid = true});
    for (int e = 0; e < static_cast<int>(sheet.edges.size()); ++e)
        CHECK(sheet.flat(e) == (sheet.edgeTriangles[e].size() == 2)); // not the rim's
}

TEST_CASE("every vertex and edge of a shape has one owner, and every element is in one leaf")
{
    geometry::TriangleMesh mesh = boxMesh({1, 1, 1}, 5);
    const int first = static_cast<int>(mesh.vertices.size());
    for (int i = 0; i < 4; ++i) mesh.vertices.push_back({2.0 + i, 0, 0});
    const CollisionShape shape = makeCollisionShape(mesh, {.segments = {{first, first + 1},
                                                                        {first + 1, first},
                                                                        {first + 2, first + 1},
                                                                        {mesh.triangles[0][0], mesh.triangles[0][1]}}});
    CHECK(shape.elements.size() ==
          mesh.triangles.size() + 2); // a line given twice counts once, and a line on a triangle is its edge
    std::vector<int> vertices(shape.rest.size()), edges(shape.edges.size()), elements(shape.elements.size());
    for (const CollisionShape::Element& element : shape.elements) {
        for (const int v : element.ownVertices)
            if (v >= 0) ++vertices[v];
        for (const int e : element.ownEdges)
            if (e >= 0) ++edges[e];
    }
    for (const CollisionShape::Node& node : shape.nodes) {
        CHECK(node.count <= 4);
        for (int i = 0; i < node.count; ++i) ++elements[node.first + i];
    }
    CHECK(vertices.back() == 0); // the vertex without line and triangle
    vertices.pop_back();
    for (const std::vector<int>* counts : {&vertices, &edges, &elements})
        CHECK(std::ranges::all_of(*counts, [](int count) { return count == 1; }));
}

TEST_CASE("the depth of a shape is never less than its proximity")
{
    CHECK(makeCollisionShape(boxMesh({1, 1, 1}), {.proximity = 0.1}).depth == 0.1);
    CHECK(makeCollisionShape(boxMesh({1, 1, 1}), {.proximity = 0.1, .depth = 0.5}).depth == 0.5);
}

TEST_CASE("boxes contain their vertices within their reach, in spite of rounding to float")
{
    std::mt19937 random(9);
    for (const double scale : {1e-4, 1.0, 1e5}) {
        CollisionSurface surface;
        geometry::TriangleMesh mesh;
        for (int i = 0; i < 500; ++i) mesh.vertices.push_back(randomVector(random, scale));
        surface.shape = std::make_shared<const CollisionShape>(makeCollisionShape(mesh, {.proximity = 0.0}));
        surface.x = mesh.vertices;
        for (int i = 0; i < 500; ++i) surface.v.push_back(randomVector(random, i % 2 == 0 ? 0.0 : scale));
        boundVertices(surface, 0.01, surface.shape->depth);
        for (int i = 0; i < 500; ++i) {
            const double r = 0.01 * length(surface.v[i]);
            const Bounds& box = surface.vertexBounds[i];
            for (int axis = 0; axis < 3; ++axis) {
                CHECK(double(box.low[axis]) <= surface.x[i][axis] - r);
                CHECK(-double(box.negatedHigh[axis]) >= surface.x[i][axis] + r);
                CHECK(double(box.low[axis]) >= surface.x[i][axis] - r - 1e-5 * scale);
            }
            CHECK(reachOf(box) >= r);
        }
    }
}

} // namespace filasofia::engine::shape_test
