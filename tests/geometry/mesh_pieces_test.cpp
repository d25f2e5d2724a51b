#include "filasofia/geometry/mesh_pieces.h"

#include "filasofia/geometry/shapes.h"
#include "geometry/sample_meshes.h"

#include <random>

namespace mesh_pieces_test {

using namespace filasofia;
using namespace filasofia::geometry;
using Catch::Matchers::Contains;

namespace {

/// The mesh with nodes of its own for every tetrahedron for which `apart` is true.
template <class Apart> TetMesh torn(const TetMesh& whole, Apart&& apart)
{
    TetMesh mesh = whole;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (int& node : mesh.tetrahedra[t])
            if (apart(t)) {
                mesh.nodes.push_back(whole.nodes[node]);
                node = static_cast<int>(mesh.nodes.size()) - 1;
            }
    std::vector<bool> used(mesh.nodes.size());
    for (const Tetrahedron& t : mesh.tetrahedra)
        for (int node : t) used[node] = true;
    std::vector<int> numbers(mesh.nodes.size());
    TetMesh out{.nodes = {}, .tetrahedra = mesh.tetrahedra, .labels = mesh.labels};
    for (std::size_t i = 0; i < used.size(); ++i) {
        numbers[i] = static_cast<int>(out.nodes.size());
        if (used[i]) out.nodes.push_back(mesh.nodes[i]);
    }
    for (Tetrahedron& t : out.tetrahedra)
        for (int& node : t) node = numbers[node];
    return out;
}

} // namespace

TEST_CASE("pieces and doubled nodes of a mesh are counted")
{
    const TetMesh block = *shapes::block({0.06, 0.04, 0.02}, {6, 4, 2});
    CHECK(piecesOf(block).pieces == 1);
    CHECK(piecesOf(block).doubled == 0);

    const auto count = static_cast<int>(block.tetrahedra.size()), nodes = static_cast<int>(block.nodes.size());
    const TetMesh dust = torn(block, [](std::size_t) { return true; });
    CHECK(piecesOf(dust).pieces == count);
    CHECK(piecesOf(dust).doubled == 4 * count - nodes);

    TetMesh two = block; // loose parts that lie apart
    for (Tetrahedron t : block.tetrahedra) {
        for (int& node : t) node += nodes;
        two.tetrahedra.push_back(t);
    }
    for (const Vec3 p : block.nodes) two.nodes.push_back(p + Vec3{1.0, 0.0, 0.0});
    CHECK(piecesOf(two).pieces == 2);
    CHECK(piecesOf(two).doubled == 0);
    for (std::size_t i = block.nodes.size(); i < two.nodes.size(); ++i) two.nodes[i].x -= 1.0 - 0.06;
    CHECK(piecesOf(two).pieces == 2);
    CHECK(piecesOf(two).doubled == 5 * 3); // the faces that touch
}

TEST_CASE("doubled nodes are found wherever they lie, within a ten-thousandth of an edge and no farther")
{
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(-1.0, 1.0);
    for (const double scale : {1e-6, 1.0, 1e6})
        for (int round = 0; round < 200; ++round) {
            TetMesh mesh = *shapes::block({1.0, 1.0, 1.0}, {1, 1, 1});
            const Vec3 shift = {place(random), round % 2 == 0 ? 0.0 : place(random), place(random)};
            for (Vec3& each : mesh.nodes) each = scale * (each + shift);
            const double within = placeDistance(mesh);
            CHECK(within == Approx(1e-4 * scale));
            TetMesh dust = torn(mesh, [](std::size_t) { return true; });
            Vec3 push = {place(random), place(random), place(random)};
            push = 0.45 * within / length(push) * push;
            for (std::size_t i = 0; i < dust.nodes.size(); i += 2) dust.nodes[i] = dust.nodes[i] + push;
            REQUIRE(piecesOf(dust).doubled == static_cast<int>(dust.nodes.size() - mesh.nodes.size()));
        }
    TetMesh mesh = *shapes::block({1.0, 1.0, 1.0}, {1, 1, 1});
    TetMesh dust = torn(mesh, [](std::size_t t) { return t == 0; });
    for (int node : dust.tetrahedra[0]) dust.nodes[node].x += 1.1e-4;
    CHECK(piecesOf(dust).doubled == 0);
}

TEST_CASE("joined nodes make a mesh whole again, with its order, its labels and its volume")
{
    TetMesh block = labelledCube(3);
    TetMesh joined = withJoinedNodes(torn(block, [](std::size_t t) { return t % 3 == 0; }), "a.msh");
    CHECK(joined.nodes.size() == block.nodes.size());
    CHECK(joined.labels == block.labels);
    CHECK(piecesOf(joined).pieces == 1);
    for (std::size_t t = 0; t < block.tetrahedra.size(); ++t)
        for (int k = 0; k < 4; ++k) CHECK(joined.nodes[joined.tetrahedra[t][k]] == block.nodes[block.tetrahedra[t][k]]);
    joined = withJoinedNodes(block, "a.msh");
    CHECK(joined.nodes == block.nodes);
    CHECK(joined.tetrahedra == block.tetrahedra);

    TetMesh twice = unitTetrahedron(); // two tetrahedra at one place
    for (const Vec3 p : unitTetrahedron().nodes) twice.nodes.push_back(p);
    twice.tetrahedra.push_back({4, 5, 6, 7});
    CHECK_THAT(errorOf([&] { (void)withJoinedNodes(twice, "a.msh"); }),
               Contains("a.msh: tetrahedra 0 and 1 lie on the same side"));
}

TEST_CASE("parts that touch in an edge or a node only get nodes of their own, and all else stays")
{
    const TetMesh one = cubeMesh(2, 1);
    CHECK(withSplitNodes(one).nodes == one.nodes);
    CHECK(withSplitNodes(one).tetrahedra == one.tetrahedra);

    // A second cube: at x + 1 and y + 1 the two share an edge of 3 nodes; at z + 1, too, a node.
    for (const auto& [shift, shared] : {std::pair{Vec3{1, 1, 0}, 3}, {Vec3{1, 1, 1}, 1}}) {
        TetMesh two = one;
        for (const Tetrahedron& t : one.tetrahedra) {
            two.tetrahedra.push_back(t);
            for (int& node : two.tetrahedra.back()) node += static_cast<int>(one.nodes.size());
        }
        for (const Vec3 p : one.nodes) two.nodes.push_back(p + shift);
        const TetMesh touching = withJoinedNodes(two, "two cubes");
        REQUIRE(touching.nodes.size() == two.nodes.size() - static_cast<std::size_t>(shared));
        const TetMesh apart = withSplitNodes(touching);
        CHECK(apart.nodes.size() == two.nodes.size());
        CHECK(std::equal(touching.nodes.begin(), touching.nodes.end(), apart.nodes.begin())); // copies come last
        CHECK(std::equal(one.tetrahedra.begin(), one.tetrahedra.end(), apart.tetrahedra.begin()));
        CHECK(piecesOf(touching).pieces == 1);
        CHECK(piecesOf(apart).pieces == 2);
        CHECK(piecesOf(apart).doubled == shared);
        CHECK(volumeOf(apart) == Approx(2.0));
        CHECK(withSplitNodes(apart).nodes == apart.nodes);
    }
}

} // namespace mesh_pieces_test
