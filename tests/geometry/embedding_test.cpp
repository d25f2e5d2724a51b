#include "filasofia/geometry/distance.h"
#include "filasofia/geometry/embedding.h"
#include "filasofia/geometry/surface_fit.h"
#include "geometry/sample_meshes.h"

namespace embedding_test {

using namespace filasofia;
using namespace filasofia::geometry;

namespace {

int nearestByHand(const TetMesh& mesh, Vec3 p)
{
    int best = -1;
    double least = std::numeric_limits<double>::infinity();
    for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t) {
        const auto [a, b, c, d] = mesh.tetrahedra[t];
        const auto w = barycentric(p, mesh.nodes[a], mesh.nodes[b], mesh.nodes[c], mesh.nodes[d]);
        const double distance =
            std::ranges::min(w) >= -1e-12
                ? 0.0
                : nearestInTetrahedron(p, mesh.nodes[a], mesh.nodes[b], mesh.nodes[c], mesh.nodes[d]).squaredDistance;
        if (distance < least) least = distance, best = t;
    }
    return best;
}

Vec3 positionOf(const TetMesh& mesh, const Embedding& embedding, std::size_t i)
{
    Vec3 sum;
    for (int k = 0; k < 4; ++k) sum += embedding.weights[i][k] * mesh.nodes[embedding.nodes[i][k]];
    return sum;
}

} // namespace

TEST_CASE("every point is embedded in the tetrahedron that brute force finds, and is given back")
{
    std::mt19937 random(1);
    const TetMesh mesh = cubeMesh(4, 1);
    std::vector<Vec3> points = mesh.nodes; // on corners, where many tetrahedra tie
    for (auto [a, b, c, d] : mesh.tetrahedra) points.push_back(0.5 * mesh.nodes[a] + 0.5 * mesh.nodes[d]);
    for (int i = 0; i < 500; ++i) points.push_back(randomPoint(random, 0, 1));
    for (int i = 0; i < 500; ++i) points.push_back(randomPoint(random, -1, 2));
    const Embedding embedding = embed(mesh, points);
    REQUIRE(embedding.nodes.size() == points.size());
    REQUIRE(embedding.weights.size() == points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        CHECK(embedding.nodes[i] == mesh.tetrahedra[nearestByHand(mesh, points[i])]);
        CHECK(distance(positionOf(mesh, embedding, i), points[i]) < 1e-13);
        const auto [a, b, c, d] = embedding.weights[i];
        CHECK(a + b + c + d == Approx(1.0).epsilon(1e-13));
    }
}

TEST_CASE("weights are not negative inside, and one of them is outside")
{
    std::mt19937 random(2);
    const TetMesh mesh = cubeMesh(3, 2);
    std::vector<Vec3> inside, outside;
    for (int i = 0; i < 300; ++i) inside.push_back(randomPoint(random, 0, 1));
    for (int i = 0; i < 300; ++i) outside.push_back(randomPoint(random, 1.01, 2));
    for (const auto& weights : embed(mesh, inside).weights) CHECK(std::ranges::min(weights) >= -1e-12);
    for (const auto& weights : embed(mesh, outside).weights) CHECK(std::ranges::min(weights) < 0.0);
}

TEST_CASE("an embedding follows a linear deformation exactly")
{
    std::mt19937 random(3);
    TetMesh mesh = cubeMesh(3, 3);
    std::vector<Vec3> points;
    for (int i = 0; i < 200; ++i) points.push_back(randomPoint(random, -0.2, 1.2));
    const Embedding embedding = embed(mesh, points);
    const auto bend = [](Vec3 p) { return Vec3{2 * p.x + p.y, p.y - p.z + 1, 0.5 * p.z + p.x}; };
    for (Vec3& node : mesh.nodes) node = bend(node);
    for (std::size_t i = 0; i < points.size(); ++i)
        CHECK(distance(positionOf(mesh, embedding, i), bend(points[i])) < 1e-12);
}

TEST_CASE("a point so far away that its distance overflows is embedded too")
{
    const std::vector<Vec3> points{{1e200, 0, 0}};
    CHECK(embed(cubeMesh(2, 1), points).nodes[0] == cubeMesh(2, 1).tetrahedra[0]);
}

TEST_CASE("no points make an empty embedding") { CHECK(embed(unitTetrahedron(), {}).nodes.empty()); }

TEST_CASE("a surface that lies elsewhere than its tetrahedra, or in other units, is odd")
{
    const TetMesh mesh = cubeMesh(2, 1); // 1 m
    const auto fit = [&](double scale, Vec3 shift) {
        std::vector<Vec3> surface;
        for (const Vec3 each : mesh.nodes) surface.push_back(scale * each + shift);
        return oddFit(surface, mesh.nodes);
    };
    CHECK(fit(1.0, {}).empty());
    CHECK(fit(1.0, {0.15, 0.0, 0.0}).empty()); // a tenth of the diagonal is 0.17 m
    CHECK(fit(0.01, {0.5, 0.5, 0.5}).empty()); // a part inside
    CHECK(fit(1.0, {0.0, -0.3, 0.0}) ==
          "is 1.732 m large, and reaches 0.3 m out of the body's tetrahedra, which are 1.732 m large");
    CHECK(fit(2.0, {}) == "is 3.464 m large, and reaches 1 m out of the body's tetrahedra, which are 1.732 m large");
    CHECK(fit(1000.0, {}) ==
          "is 1732 m large, and reaches 999 m out of the body's tetrahedra, which are 1.732 m large; if one of them is "
          "in millimetres, give it a scale of 0.001");
    CHECK(fit(0.001, {}) ==
          "is 0.001732 m large, inside the body's tetrahedra, which are 1.732 m large; if one of them "
          "is in millimetres, give it a scale of 0.001");
}

} // namespace embedding_test
