#include "filasofia/engine/soft/coarse_mesh.h"

#include "engine/stage.h"

#include <Eigen/Eigenvalues>

#include <numeric>

namespace coarse_mesh_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

/// The least eigenvalue of P^T P, with a diagonal of ones.
double leastEigenvalue(const geometry::CoarseLattice& lattice)
{
    Eigen::MatrixXd p = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(lattice.corners.size()), lattice.nodeCount);
    for (std::size_t i = 0; i < lattice.corners.size(); ++i)
        for (std::size_t k = 0; k < 4; ++k)
            if (lattice.weights[i][k] != 0.0f)
                p(static_cast<Eigen::Index>(i), lattice.corners[i][k]) += lattice.weights[i][k];
    for (Eigen::Index c = 0; c < p.cols(); ++c) p.col(c) /= p.col(c).norm();
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(p.transpose() * p).eigenvalues()[0];
}

} // namespace

TEST_CASE("no coarse node depends on others, however many light nodes have coarse nodes of their own")
{
    const geometry::TetMesh mesh = boxMesh({5, 3, 3}, {0.05, 0.03, 0.03}, 0.2);
    std::vector<std::array<int, 2>> edges;
    for (const geometry::Tetrahedron& each : mesh.tetrahedra)
        for (const auto& [i, j] : geometry::kTetrahedronEdges) edges.push_back({each[i], each[j]});
    std::vector<int> nodes(mesh.nodes.size());
    std::iota(nodes.begin(), nodes.end(), 0);
    const std::vector<bool> held(mesh.nodes.size());
    std::mt19937 random(7);
    for (int share = 0; share < 5; ++share) { // tenths of all nodes that are light
        std::vector<double> masses;
        for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
            masses.push_back(static_cast<int>(random() % 10) < share ? 1e-6 : 1e-3);
        const BuiltLattice built =
            buildLattice({mesh.nodes, edges, nodes, held, {}, masses}, coarseChoiceAfterCut(nodes.size()));
        INFO(share << " tenths: " << built.lattice.nodeCount << " coarse nodes");
        REQUIRE(built.lattice.nodeCount > 12);
        CHECK(leastEigenvalue(built.lattice) > 5e-3);
        for (const std::array<float, 4>& each : built.lattice.weights)
            CHECK(std::abs(each[0] + each[1] + each[2] + each[3] - 1.0f) < 1e-6f);
    }
}

} // namespace coarse_mesh_test
