#include "filasofia/geometry/adjacency.h"
#include "filasofia/geometry/embedding.h"
#include "filasofia/geometry/mesh_file.h"
#include "geometry/sample_meshes.h"

namespace bunny_test {

using namespace filasofia;
using namespace filasofia::geometry;

namespace {

std::filesystem::path asset(const std::string& name)
{
    return std::filesystem::path(FILASOFIA_SOURCE_DIR) / "assets" / "meshes" / name;
}

constexpr int kBunnies[] = {756, 1492, 3004, 10000, 30000};

} // namespace

TEST_CASE("each bunny has as many tetrahedra as its name says, in one piece, with a closed surface around its volume")
{
    for (int named : kBunnies) {
        CAPTURE(named);
        const TetMesh mesh = loadTetMesh(asset(text("bunny_", named, ".msh")));
        CHECK(static_cast<double>(mesh.tetrahedra.size()) == Approx(named).epsilon(0.01));
        CHECK(connectedComponents(mesh).count == 1);
        const Surface surface = extractSurface(mesh);
        CHECK_NOTHROW(check(surface.mesh, "surface"));
        CHECK(isClosedManifold(surface.mesh));
        CHECK(volumeInside(surface.mesh) == Approx(volumeOf(mesh)).epsilon(1e-12));
    }
}

TEST_CASE("the bunny's skin has 1839 vertices and can be embedded in every bunny without moving a vertex")
{
    const TriangleMesh skin = loadTriangleMesh(asset("bunny.obj"));
    CHECK(skin.vertices.size() == 1839);
    CHECK(isClosedManifold(skin));
    for (int named : kBunnies) {
        CAPTURE(named);
        const TetMesh mesh = loadTetMesh(asset(text("bunny_", named, ".msh")));
        const Embedding embedding = embed(mesh, skin.vertices);
        double worst = 0.0;
        for (std::size_t i = 0; i < skin.vertices.size(); ++i) {
            Vec3 sum;
            for (int k = 0; k < 4; ++k) sum += embedding.weights[i][k] * mesh.nodes[embedding.nodes[i][k]];
            worst = std::max(worst, distance(sum, skin.vertices[i]));
        }
        CHECK(worst < 1e-12);
    }
}

} // namespace bunny_test
