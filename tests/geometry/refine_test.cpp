#include "filasofia/geometry/refine.h"

#include "filasofia/geometry/adjacency.h"
#include "filasofia/geometry/mesh_file.h"
#include "geometry/sample_meshes.h"

namespace refine_test {

using namespace filasofia;
using namespace filasofia::geometry;

namespace {

TetMesh bunny()
{
    return loadTetMesh(std::filesystem::path(FILASOFIA_SOURCE_DIR) / "assets" / "meshes" / "bunny_1492.msh");
}

double worstQuality(const TetMesh& mesh)
{
    double worst = 1.0;
    for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t) worst = std::min(worst, quality(mesh, t));
    return worst;
}

} // namespace

TEST_CASE("a refined tetrahedron is eight of an eighth of its volume, around its shortest inner diagonal")
{
    // Two opposite edges lie close to each other, so the diagonal between their midpoints is the shortest.
    const Vec3 a{-1, 0, 0}, b{1, 0, 0}, c{0, -1, -0.3}, d{0, 1, -0.3};
    const std::vector<std::pair<std::vector<Vec3>, std::array<int, 2>>> cases{
        {{a, b, c, d}, {4, 9}}, {{a, d, b, c}, {5, 8}}, {{a, c, d, b}, {6, 7}}}; // midpoints of 01 23, 02 13, 03 12
    for (const auto& [nodes, middles] : cases) {
        CAPTURE(middles[0], middles[1]);
        const TetMesh mesh{nodes, {{0, 1, 2, 3}}}, fine = refined(mesh);
        REQUIRE(fine.nodes.size() == 10);
        REQUIRE(fine.tetrahedra.size() == 8);
        CHECK(fine.labels.empty());
        CHECK(distance(fine.nodes[middles[0]], fine.nodes[middles[1]]) == Approx(0.3));
        CHECK_NOTHROW(check(fine, "fine"));
        for (int t = 0; t < 8; ++t) CHECK(signedVolume(fine, t) == Approx(volumeOf(mesh) / 8).epsilon(1e-12));
        for (int t = 0; t < 4; ++t)
            CHECK(quality(fine, t) == Approx(quality(mesh, 0)).epsilon(1e-12)); // the tetrahedra at the corners
        for (int t = 4; t < 8; ++t)
            for (int middle : middles) CHECK(std::ranges::count(fine.tetrahedra[t], middle) == 1);
    }
}

TEST_CASE("a refined mesh is conforming: same volume, closed surface, matching faces, old nodes unmoved")
{
    for (const TetMesh& mesh : {cubeMesh(3, 7), bunny()}) {
        const TetMesh fine = refined(mesh);
        CHECK(fine.tetrahedra.size() == 8 * mesh.tetrahedra.size());
        CHECK(fine.nodes.size() == mesh.nodes.size() + edges(mesh).size());
        CHECK(std::equal(mesh.nodes.begin(), mesh.nodes.end(), fine.nodes.begin()));
        CHECK_NOTHROW(check(fine, "fine"));
        CHECK(volumeOf(fine) == Approx(volumeOf(mesh)).epsilon(1e-12));
        const Surface coarseSurface = extractSurface(mesh), surface = extractSurface(fine);
        CHECK(isClosedManifold(surface.mesh));
        CHECK(surface.mesh.triangles.size() == 4 * coarseSurface.mesh.triangles.size()); // no inner face is exposed
    }
}

TEST_CASE("refining again and again does not flatten the elements")
{
    const TetMesh once = refined(bunny()), twice = refined(once);
    CHECK(twice.tetrahedra.size() == 64 * bunny().tetrahedra.size());
    CHECK_NOTHROW(check(twice, "twice"));
    CHECK(worstQuality(once) > 0.5 * worstQuality(bunny()));
    CHECK(worstQuality(twice) > 0.5 * worstQuality(bunny()));
}

TEST_CASE("the parts of a refined mesh keep their labels")
{
    TetMesh mesh = cubeMesh(2, 1);
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) mesh.labels.push_back(static_cast<int>(t));
    mesh.labelNames = {{3, "tumour"}};
    const TetMesh fine = refined(mesh);
    CHECK(fine.labelNames == mesh.labelNames);
    REQUIRE(fine.labels.size() == fine.tetrahedra.size());
    std::vector<double> volumes(mesh.tetrahedra.size());
    for (std::size_t t = 0; t < fine.labels.size(); ++t)
        volumes[static_cast<std::size_t>(fine.labels[t])] += signedVolume(fine, static_cast<int>(t));
    for (std::size_t t = 0; t < volumes.size(); ++t)
        CHECK(volumes[t] == Approx(signedVolume(mesh, static_cast<int>(t))));
}

} // namespace refine_test
