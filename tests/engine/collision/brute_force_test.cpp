#include "engine/collision/brute_force.h"

#include <set>

namespace filasofia::engine::brute_force_test {
namespace {

geometry::TriangleMesh bentSheet(std::mt19937& random)
{
    geometry::TriangleMesh mesh = sheetMesh(1.0, 4);
    for (Vec3& p : mesh.vertices) p += randomVector(random, 0.12);
    return mesh;
}

std::vector<std::array<int, 2>> chain(std::size_t count)
{
    std::vector<std::array<int, 2>> segments;
    for (int i = 1; i < static_cast<int>(count); ++i) segments.push_back({i - 1, i});
    return segments;
}

// Intersecting lumps, sheets, chains of segments and clouds of points, with random combinations of active features.
Scene randomScene(std::mt19937& random)
{
    Scene scene;
    scene.dt = 0.05;
    std::uniform_int_distribution<int> count(2, 4), kind(0, 7), coin(0, 3);
    for (int left = count(random); left > 0; --left) {
        CollisionOptions options{.proximity = 0.06, .depth = 0.4};
        options.points = coin(random) != 0;
        options.lines = coin(random) != 0;
        options.triangleFaces = coin(random) != 0;
        options.group = coin(random) == 0 ? 1 : 0;
        geometry::TriangleMesh mesh;
        switch (const int k = kind(random); k) {
        case 0:
            mesh = bentSheet(random);
            break;
        case 1:
        case 2:
            for (int i = 0; i < 12; ++i) mesh.vertices.push_back(randomVector(random, 1.0));
            if (k == 2) options.segments = chain(mesh.vertices.size());
            break;
        case 3:
            mesh = boxMesh({0.6, 0.7, 0.8}, 2);
            break;
        default:
            mesh = lumpMesh(0.8, 5, 0.25, random);
        }
        const Pose pose{randomVector(random, 0.8), axisAngle(randomVector(random, 1.0), 3.0 * (coin(random) + 0.5))};
        const int at = scene.add(mesh, options, pose);
        for (Vec3& v : scene.surfaces[static_cast<std::size_t>(at)].v) v = randomVector(random, 2.0);
        if (coin(random) == 0) scene.surfaces.back().element = -1; // tissue
        if (coin(random) == 0) scene.surfaces.back().name = {scene.surfaces.front().name.body, at};
    }
    return scene;
}

brute::Key keyOf(const Proximity& p)
{
    return {p.surfaces, {brute::sorted(p.vertices[0]), brute::sorted(p.vertices[1])}};
}

} // namespace

TEST_CASE("proximities match a brute-force search over all features, with the same gaps and normals")
{
    std::mt19937 random(7);
    int edges = 0, faces = 0, others = 0, negative = 0, negativeEdges = 0, bentEdges = 0;
    for (int round = 0; round < 300; ++round) {
        Scene scene = randomScene(random);
        scene.find();
        std::vector<brute::Key> closeCalls;
        const brute::Answers expected = brute::answers(scene, closeCalls);
        std::set<brute::Key> mine;
        for (const Proximity& p : scene.found) {
            const brute::Key key = keyOf(p);
            CAPTURE(round, p.surfaces, p.vertices[0], p.vertices[1], p.gap);
            REQUIRE(mine.insert(key).second);
            if (std::ranges::find(closeCalls, key) != closeCalls.end()) continue;
            const auto it = expected.find(key);
            REQUIRE(it != expected.end());
            REQUIRE(p.gap == Approx(it->second.gap).margin(1e-9));
            REQUIRE(distance(p.normal, it->second.normal) < 1e-5);
            REQUIRE(distance(scene.place(p, 0) - scene.place(p, 1), p.gap * p.normal) < 1e-9);
            const bool isEdges = key.corners[0][1] >= 0 && key.corners[1][1] >= 0;
            const bool isFace = key.corners[0][0] >= 0 || key.corners[1][0] >= 0;
            ++(isEdges ? edges : isFace ? faces : others);
            negative += p.gap < 0.0, negativeEdges += p.gap < 0.0 && isEdges;
            bentEdges += isEdges && !it->second.nearest;
        }
        for (const auto& [key, answer] : expected) {
            CAPTURE(round, key.surfaces, key.corners[0], key.corners[1], answer.gap);
            REQUIRE((mine.contains(key) || std::ranges::find(closeCalls, key) != closeCalls.end()));
        }
    }
    CHECK(faces > 300);
    CHECK(edges > 300);
    CHECK(others > 300);
    CHECK(negative > 100);
    CHECK(negativeEdges > 20);
    CHECK(bentEdges > 20);
}

TEST_CASE("feature numbers are unique within a pair of surfaces, and the list is the same for 1, 2 and 8 threads")
{
    std::mt19937 random(11);
    Scene scene;
    for (int i = 0; i < 6; ++i) {
        const geometry::TriangleMesh mesh = lumpMesh(0.8, 14, 0.1, random);
        scene.add(mesh, {.proximity = 0.05, .depth = 0.2, .self = i == 0}, {randomVector(random, 0.7), {}});
    }
    const std::vector<Proximity> one = scene.find(1);
    REQUIRE(one.size() > 500);
    std::set<std::pair<std::array<int, 2>, std::uint64_t>> features;
    for (const Proximity& p : one) REQUIRE(features.insert({p.surfaces, p.feature}).second);
    for (const int threads : {2, 8}) {
        Scene again = scene;
        again.scratch = {};
        const std::vector<Proximity> many = again.find(threads);
        REQUIRE(many.size() == one.size());
        for (std::size_t i = 0; i < one.size(); ++i) {
            REQUIRE(many[i].feature == one[i].feature);
            REQUIRE(many[i].vertices == one[i].vertices);
            REQUIRE(many[i].weights == one[i].weights);
            REQUIRE(many[i].normal == one[i].normal);
            REQUIRE(many[i].gap == one[i].gap);
        }
    }
}

} // namespace filasofia::engine::brute_force_test
