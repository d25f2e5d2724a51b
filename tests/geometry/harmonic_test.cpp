#include "filasofia/geometry/harmonic.h"

#include "filasofia/geometry/box.h"

#include "geometry/sample_meshes.h"

namespace harmonic_test {

using namespace filasofia;
using namespace filasofia::geometry;

TEST_CASE("the harmonic function between two faces of a cube is linear, and its gradient constant")
{
    const TetMesh mesh = cubeMesh(4, 1);
    const Box box = boxAround(mesh.nodes);
    std::vector<std::optional<double>> given(mesh.nodes.size());
    for (std::size_t i = 0; i < given.size(); ++i) {
        if (mesh.nodes[i].y < box.low.y + 1e-9) given[i] = 2.0;
        if (mesh.nodes[i].y > box.high.y - 1e-9) given[i] = 5.0;
    }
    const std::vector<double> found = harmonicFunction(mesh, given);
    const double slope = 3.0 / (box.high.y - box.low.y);
    for (std::size_t i = 0; i < found.size(); ++i)
        CHECK(std::abs(found[i] - 2.0 - slope * (mesh.nodes[i].y - box.low.y)) < 1e-12);
    for (const Vec3& g : gradients(mesh, found)) CHECK(length(g - Vec3{0, slope, 0}) < 1e-10);
}

TEST_CASE("the harmonic function is zero in a piece without given values")
{
    const TetMesh mesh = unitTetrahedron();
    for (double value : harmonicFunction(mesh, std::vector<std::optional<double>>(4))) CHECK(value == 0.0);
}

} // namespace harmonic_test
