#include "engine/rupture/meshes.h"

#include "filasofia/engine/rupture/tet_shape.h"
#include "filasofia/geometry/distance.h"

#include <random>

namespace editable_mesh_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

using Random = std::mt19937;

double uniform(Random& random, double low, double high) { return std::uniform_real_distribution(low, high)(random); }

/// A random edge of the mesh.
std::array<int, 2> anyEdge(const EditableMesh& mesh, Random& random)
{
    const geometry::Tetrahedron& n = mesh.data().tetrahedra[random() % mesh.data().tetrahedra.size()];
    const auto [i, j] = geometry::kTetrahedronEdges[random() % 6];
    return {n[i], n[j]};
}

double volumeOf(const MeshTopology& mesh)
{
    double sum = 0.0;
    for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t) sum += restVolume(mesh, t);
    return sum;
}

/// Flags all faces in the plane x = 0, which is a plane of nodes of the bar.
std::vector<int> flagMiddle(EditableMesh& mesh)
{
    std::vector<int> nodes;
    const MeshTopology& data = mesh.data();
    for (int t = 0; t < mesh.tetrahedra(); ++t)
        for (int f = 0; f < 4; ++f) {
            const auto n = faceNodes(data.tetrahedra[t], f);
            if (!std::ranges::all_of(n, [&](int k) { return std::abs(data.rest[k].x) < 1e-12; })) continue;
            mesh.setFlagged(t, f, true);
            nodes.insert(nodes.end(), n.begin(), n.end());
        }
    std::ranges::sort(nodes);
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
}

} // namespace

TEST_CASE("bisecting edges keeps the mesh valid, its volume, and every linear field exact")
{
    Random random(1);
    EditableMesh mesh = bar(2);
    const auto field = [](Vec3 p) { return 3.0 + 20.0 * p.x - 7.0 * p.y + 11.0 * p.z; };
    std::vector<Vec3> moved = mesh.data().rest;
    for (Vec3& p : moved) p = {p.y + 0.1, 1.5 * p.x, p.z + 0.3 * p.x};
    mesh.moveTo(moved);
    std::vector<double> values;
    for (Vec3 p : mesh.data().rest) values.push_back(field(p));
    for (int i = 0; i < 300; ++i) {
        const auto [a, b] = anyEdge(mesh, random);
        mesh.bisect(a, b, uniform(random, 0.2, 0.8));
        frame::followNodes(mesh.takeEdit({1}), values);
    }
    CHECK(faultsOf(mesh, 0.0) == "");
    CHECK(std::abs(volumeOf(mesh.data()) / mesh.startVolume() - 1.0) < 1e-13);
    REQUIRE(values.size() == mesh.data().rest.size());
    for (int n = 0; n < mesh.nodes(); ++n) {
        CHECK(values[n] == Approx(field(mesh.data().rest[n])).epsilon(1e-14));
        const Vec3 p = mesh.data().rest[n];
        CHECK(distance(mesh.data().current[n], {p.y + 0.1, 1.5 * p.x, p.z + 0.3 * p.x}) < 1e-16);
    }
}

TEST_CASE("bisecting conserves momentum and mass if masses are redistributed")
{
    Random random(2);
    EditableMesh mesh = bar(2);
    std::vector<Vec3> velocities;
    for (int n = 0; n < mesh.nodes(); ++n)
        velocities.push_back({uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)});
    // The momentum of the velocity field, linear in each element: each corner counts with a quarter of the element's
    // mass.
    const auto momentum = [&] {
        Vec3 sum;
        for (int t = 0; t < mesh.tetrahedra(); ++t)
            for (int n : mesh.data().tetrahedra[t]) sum += 250.0 * restVolume(mesh.data(), t) * velocities[n];
        return sum;
    };
    const Vec3 before = momentum();
    for (int i = 0; i < 200; ++i) {
        const auto [a, b] = anyEdge(mesh, random);
        mesh.bisect(a, b, uniform(random, 0.3, 0.7));
        frame::followNodes(mesh.takeEdit({1}), velocities);
        CHECK(distance(momentum(), before) < 1e-15);
    }
}

TEST_CASE("points embedded in a mesh stay in place when it is bisected")
{
    Random random(3);
    EditableMesh mesh = bar(2);
    std::vector<geometry::Tetrahedron> tetrahedra = mesh.data().tetrahedra;
    std::vector<Vec3> rest = mesh.data().rest;
    std::vector<frame::EmbeddedPoint> points;
    std::vector<Vec3> places;
    for (int i = 0; i < 2000; ++i) {
        frame::EmbeddedPoint p{static_cast<int>(random() % mesh.data().tetrahedra.size()), {}};
        double sum = 0.0;
        for (double& w : p.weights) sum += w = uniform(random, 0, 1);
        for (double& w : p.weights) w /= sum;
        if (i % 10 == 0) p.weights = {0.5, 0.0, 0.5, 0.0};
        points.push_back(p);
    }
    const auto at = [&](const frame::EmbeddedPoint& p) {
        Vec3 sum;
        for (int k = 0; k < 4; ++k) sum += p.weights[k] * mesh.data().rest[mesh.data().tetrahedra[p.tetrahedron][k]];
        return sum;
    };
    for (const auto& p : points) places.push_back(at(p));
    for (int i = 0; i < 400; ++i) {
        const auto [a, b] = anyEdge(mesh, random);
        mesh.bisect(a, b, uniform(random, 0.2, 0.8));
        if (i % 7 != 0) continue; // one edit may split an element several times
        frame::followPoints(mesh.takeEdit({1}), tetrahedra, rest, points);
    }
    frame::followPoints(mesh.takeEdit({1}), tetrahedra, rest, points);
    CHECK(tetrahedra == mesh.data().tetrahedra);
    CHECK(rest == mesh.data().rest);
    int elsewhere = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        CHECK(distance(at(points[i]), places[i]) < 1e-14 * mesh.diagonal());
        CHECK(std::ranges::min(points[i].weights) >= 0.0);
        elsewhere += points[i].tetrahedron >= 2 * 2 * 4 * 6 ? 1 : 0;
    }
    CHECK(elsewhere > 300);
}

TEST_CASE("a node splits into one copy per group of elements, and only if the flagged faces separate them")
{
    EditableMesh mesh = bar(2);
    const std::vector<int> nodes = flagMiddle(mesh);
    REQUIRE(nodes.size() == 9);
    for (int node : nodes) CHECK(mesh.split(node) == 1);
    CHECK(mesh.openedFaces().size() == 8);
    for (const EditableMesh::Copy& copy : mesh.copies()) CHECK(mesh.originOf(copy.copy) == copy.from);
    mesh.commit();
    CHECK(faultsOf(mesh, 0.0) == "");
    for (int node : nodes) CHECK(mesh.split(node) == 0);
    mesh.commit();
}

TEST_CASE("a transaction that is rolled back leaves the mesh bit-identical")
{
    Random random(4);
    EditableMesh mesh = bar(2);
    for (int i = 0; i < 50; ++i) {
        const auto [a, b] = anyEdge(mesh, random);
        mesh.bisect(a, b, 0.5);
    }
    static_cast<void>(mesh.takeEdit({1}));
    for (int round = 0; round < 50; ++round) {
        std::vector<int> nodes;
        for (int i = 0; i < 200; ++i) {
            const int t = static_cast<int>(random() % mesh.data().tetrahedra.size()),
                      f = static_cast<int>(random() % 4);
            mesh.setFlagged(t, f, random() % 2 == 0);
            nodes.push_back(mesh.data().tetrahedra[t][(f + 1) % 4]);
        }
        const MeshTopology before = mesh.data();
        int copies = 0;
        for (int node : nodes) copies += mesh.split(node);
        if (round > 5) CHECK(copies > 0);
        if (copies > 0) CHECK(!(mesh.data() == before));
        mesh.rollBack();
        CHECK(mesh.data() == before);
        CHECK(!mesh.edited());
    }
}

TEST_CASE("a slide moves rest and current positions by the same fraction, and the edit records the old position")
{
    EditableMesh mesh = bar(2);
    const geometry::Tetrahedron n = mesh.data().tetrahedra[5];
    const Vec3 old = mesh.data().rest[n[0]], other = mesh.data().rest[n[1]];
    std::vector<Vec3> values = mesh.data().rest;
    mesh.slide(n[0], n[1], 0.1);
    const frame::TopologyEdit edit = mesh.takeEdit({7});
    REQUIRE(edit.ops.size() == 1);
    const auto& move = std::get<frame::NodeMove>(edit.ops[0]);
    CHECK(move.oldRest == old);
    CHECK(move.newRest == mesh.data().rest[n[0]]);
    CHECK(distance(move.newRest, 0.9 * old + 0.1 * other) < 1e-17);
    CHECK(edit.changed.size() == mesh.data().around[n[0]].size());
    CHECK(edit.boundary.empty());
    CHECK(edit.body == BodyId{7});
    CHECK(edit.revision == 1);
    frame::followNodes(edit, values);
    CHECK(values == mesh.data().rest);
    CHECK(mesh.takeEdit({7}).empty());
}

} // namespace editable_mesh_test
