#include "filasofia/engine/collision/inset.h"
#include "filasofia/geometry/shapes.h"

#include "engine/meshes.h"

#include "filasofia/geometry/surface.h"

namespace inset_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

struct Made {
    CollisionShape shape;
    Inset inset;
    std::vector<Vec3> x;
};

Made inset(const geometry::TriangleMesh& mesh, double depth)
{
    Made made{makeCollisionShape(mesh, {}), {}, mesh.vertices};
    made.inset = makeInset(made.shape, depth);
    std::vector<Vec3> normals;
    applyInset(made.shape, made.inset, normals, made.x);
    return made;
}

} // namespace

TEST_CASE("every face of a box moves inwards by the depth, and the corners with the faces")
{
    const Made made = inset(*geometry::shapes::box(2.0 * Vec3{0.02, 0.03, 0.01}), 1e-3);
    for (std::size_t i = 0; i < made.x.size(); ++i) {
        CHECK(std::abs(made.x[i].x) == Approx(0.019).margin(3e-6)); // a thousandth goes into telling normals apart
        CHECK(std::abs(made.x[i].y) == Approx(0.029).margin(3e-6));
        CHECK(std::abs(made.x[i].z) == Approx(0.009).margin(3e-6));
        CHECK(made.inset.depth[i] == 1e-3);
    }
}

TEST_CASE("a flat surface of many triangles moves inwards evenly, and a ball becomes a smaller ball")
{
    const geometry::TriangleMesh block = geometry::extractSurface(boxMesh({4, 4, 4}, {0.04, 0.04, 0.04})).mesh;
    const Made made = inset(block, 5e-4);
    for (std::size_t i = 0; i < made.x.size(); ++i)
        for (int axis = 0; axis < 3; ++axis) {
            const double was = block.vertices[i][axis], now = made.x[i][axis];
            const double expected = was == 0.0 ? 5e-4 : was == 0.04 ? -5e-4 : 0.0;
            CHECK(now - was == Approx(expected).margin(2e-6));
        }
    const Made ball = inset(*geometry::shapes::sphere(0.02, 16), 2e-4);
    for (Vec3 p : ball.x) CHECK(length(p) == Approx(0.0198).margin(2e-6));
}

TEST_CASE("a thin body gets a smaller inset, and a sheet none")
{
    const Made plate = inset(*geometry::shapes::box(2.0 * Vec3{0.02, 0.0005, 0.02}), 1e-3);
    for (Vec3 p : plate.x) CHECK(std::abs(p.y) >= 0.499 * 0.0005); // at corners the normals agree except for the ridge
    geometry::TriangleMesh sheet{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {}};
    const Made open = inset(sheet, 0.1);
    CHECK(open.x == sheet.vertices);
    CHECK(open.inset.depth == std::vector<double>{0.0, 0.0, 0.0});
}

TEST_CASE("the inset rotates with the body")
{
    std::mt19937 random(4);
    const geometry::TriangleMesh box = *geometry::shapes::box(2.0 * Vec3{0.02, 0.03, 0.01});
    const Made made = inset(box, 1e-3);
    const Quat turn = randomRotation(random);
    std::vector<Vec3> x, normals;
    for (Vec3 p : box.vertices) x.push_back(rotate(turn, p));
    applyInset(made.shape, made.inset, normals, x);
    for (std::size_t i = 0; i < x.size(); ++i) CHECK(distance(x[i], rotate(turn, made.x[i])) < 1e-12);
}

TEST_CASE("needles and triangles without area have a finite inset")
{
    geometry::TriangleMesh needle = *geometry::shapes::sphere(1.0, 4);
    for (Vec3& p : needle.vertices) p = {0.05 * p.x, 1e-4 * p.y, 1e-4 * p.z};
    const Made made = inset(needle, 1e-3);
    for (Vec3 p : made.x) CHECK(isFinite(p));
    for (std::size_t i = 0; i < made.x.size(); ++i) CHECK(distance(made.x[i], needle.vertices[i]) <= 2e-3);
    geometry::TriangleMesh flat = *geometry::shapes::box(2.0 * Vec3{0.01, 0.01, 0.01});
    for (Vec3& p : flat.vertices) p.y = 0.0;
    for (Vec3 p : inset(flat, 1e-3).x) CHECK(isFinite(p));
}

} // namespace inset_test
