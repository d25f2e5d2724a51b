#include "filasofia/geometry/harmonic.h"

#include "filasofia/core/assert.h"
#include "filasofia/geometry/adjacency.h"

#include <Eigen/SparseCholesky>

namespace filasofia::geometry {
namespace {

/// The gradients of the shape functions.
std::array<Vec3, 4> shapeGradients(const TetMesh& mesh, const Tetrahedron& t)
{
    std::array<Vec3, 4> out;
    for (std::size_t i = 0; i < 4; ++i) {
        const auto& [a, b, c] = kTetrahedronFaces[i];
        const Vec3 pa = mesh.nodes[t[a]], outward = cross(mesh.nodes[t[b]] - pa, mesh.nodes[t[c]] - pa);
        out[i] = 1.0 / dot(outward, mesh.nodes[t[i]] - pa) * outward;
    }
    return out;
}

} // namespace

std::vector<double> harmonicFunction(const TetMesh& mesh, const std::vector<std::optional<double>>& given)
{
    FILASOFIA_ASSERT(given.size() == mesh.nodes.size());
    // A piece without a given value would make the matrix singular: its first node gets zero.
    std::vector<std::optional<double>> known(given);
    const Components pieces = connectedComponents(mesh);
    std::vector<char> anchored(static_cast<std::size_t>(pieces.count));
    for (std::size_t i = 0; i < known.size(); ++i)
        if (known[i]) anchored[static_cast<std::size_t>(pieces.ofNode[i])] = 1;
    std::vector<int> row(mesh.nodes.size(), -1);
    int rows = 0;
    for (std::size_t i = 0; i < known.size(); ++i) {
        char& has = anchored[static_cast<std::size_t>(pieces.ofNode[i])];
        if (!has) known[i] = 0.0;
        has = 1;
        if (!known[i]) row[i] = rows++;
    }

    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd load = Eigen::VectorXd::Zero(rows);
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
        const Tetrahedron& t = mesh.tetrahedra[e];
        const std::array<Vec3, 4> g = shapeGradients(mesh, t);
        const double volume = signedVolume(mesh, static_cast<int>(e));
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = 0; j < 4 && row[t[i]] >= 0; ++j)
                if (const double entry = volume * dot(g[i], g[j]); row[t[j]] >= 0)
                    entries.emplace_back(row[t[i]], row[t[j]], entry);
                else
                    load[row[t[i]]] -= entry * *known[t[j]];
    }
    Eigen::SparseMatrix<double> matrix(rows, rows);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::VectorXd solution = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(load);
    std::vector<double> out;
    for (std::size_t i = 0; i < known.size(); ++i) out.push_back(known[i] ? *known[i] : solution[row[i]]);
    return out;
}

std::vector<Vec3> gradients(const TetMesh& mesh, const std::vector<double>& values)
{
    FILASOFIA_ASSERT(values.size() == mesh.nodes.size());
    std::vector<Vec3> out;
    for (const Tetrahedron& t : mesh.tetrahedra) {
        const std::array<Vec3, 4> g = shapeGradients(mesh, t);
        Vec3 sum;
        for (std::size_t i = 0; i < 4; ++i) sum += values[t[i]] * g[i];
        out.push_back(sum);
    }
    return out;
}

} // namespace filasofia::geometry
