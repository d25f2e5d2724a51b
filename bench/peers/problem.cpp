#include "bench/peers/problem.h"

#include "filasofia/geometry/mesh_file.h"

#include <cmath>
#include <string>

namespace filasofia::peers {

Problem hangingBunny(int tets)
{
    const std::string file = FILASOFIA_MESHES "/bunny_" + std::to_string(tets) + ".msh";
    Problem problem;
    problem.mesh = std::make_shared<geometry::TetMesh>(geometry::loadTetMesh(file));
    const std::vector<Vec3>& nodes = problem.mesh->nodes;
    for (std::size_t node = 0; node < nodes.size(); ++node)
        if (nodes[node].y > kPinnedAbove) problem.pinned.push_back(static_cast<int>(node));
    return problem;
}

Problem restingBunny(const Problem& hanging)
{
    Problem problem = hanging;
    problem.dt = 0.02;
    problem.steps = 250;
    problem.rayleighMass = 10.0; // the remaining swing after these 5 s is below 1e-10
    return problem;
}

std::vector<double> lumpedMasses(const Problem& problem)
{
    const geometry::TetMesh& mesh = *problem.mesh;
    std::vector<double> masses(mesh.nodes.size(), 0.0);
    for (std::size_t element = 0; element < mesh.tetrahedra.size(); ++element) {
        const double quarter = kDensity * geometry::signedVolume(mesh, static_cast<int>(element)) / 4.0;
        for (int node : mesh.tetrahedra[element]) masses[static_cast<std::size_t>(node)] += quarter;
    }
    for (int node : problem.pinned) masses[static_cast<std::size_t>(node)] = 0.0;
    return masses;
}

double relativeError(const std::vector<Vec3>& x, const std::vector<Vec3>& exact, const Problem& problem)
{
    double distance = 0.0, moved = 0.0;
    for (std::size_t node = 0; node < exact.size(); ++node) {
        distance += dot(x[node] - exact[node], x[node] - exact[node]);
        moved += dot(exact[node] - problem.mesh->nodes[node], exact[node] - problem.mesh->nodes[node]);
    }
    return std::sqrt(distance / moved);
}

} // namespace filasofia::peers
