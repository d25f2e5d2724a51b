#include "filasofia/geometry/dependent_nodes.h"

#include "geometry/sample_meshes.h"

#include <array>
#include <cmath>

namespace dependent_nodes_test {

using namespace filasofia::geometry;

TEST_CASE("of two coarse nodes that only one node uses, the one with less weight is dropped")
{
    CoarseLattice lattice{.nodeCount = 4,
                          .corners = {{0, 0, 0, 0}, {1, 1, 1, 1}, {0, 2, 3, 0}},
                          .weights = {{1.0f}, {1.0f}, {0.6f, 0.3f, 0.1f, 0.0f}}};
    dropDependent(lattice);
    CHECK(lattice.weights[0] == std::array{1.0f, 0.0f, 0.0f, 0.0f});
    CHECK(lattice.weights[2][2] == 0.0f);
    CHECK(std::abs(lattice.weights[2][0] - 2.0f / 3.0f) < 1e-6f);
    CHECK(std::abs(lattice.weights[2][1] - 1.0f / 3.0f) < 1e-6f);
}

TEST_CASE("coarse nodes that depend on no others stay, and weights of nodes without any stay zero")
{
    const CoarseLattice before{.nodeCount = 3,
                               .corners = {{0, 1, 0, 0}, {1, 2, 0, 0}, {2, 0, 0, 0}, {0, 0, 0, 0}},
                               .weights = {{0.7f, 0.3f}, {0.7f, 0.3f}, {0.7f, 0.3f}, {}}};
    CoarseLattice after = before;
    dropDependent(after);
    CHECK(after.corners == before.corners);
    CHECK(after.weights == before.weights);
}

TEST_CASE("three coarse nodes that two nodes use become two, and both nodes keep their sums")
{
    CoarseLattice lattice{.nodeCount = 3,
                          .corners = {{0, 1, 2, 0}, {0, 1, 2, 0}, {0, 0, 0, 0}},
                          .weights = {{0.5f, 0.3f, 0.2f, 0.0f}, {0.2f, 0.6f, 0.2f, 0.0f}, {}}};
    dropDependent(lattice);
    for (std::size_t i = 0; i < 2; ++i) {
        CHECK(lattice.weights[i][2] == 0.0f);
        CHECK(std::abs(lattice.weights[i][0] + lattice.weights[i][1] - 1.0f) < 1e-6f);
    }
    CHECK(lattice.weights[2] == std::array{0.0f, 0.0f, 0.0f, 0.0f});
}

} // namespace dependent_nodes_test
