#pragma once

#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/math/quat.h"

#include <algorithm>
#include <memory>
#include <random>
#include <string>

namespace filasofia {

inline Vec3 randomVec3(std::mt19937& random, double size)
{
    std::uniform_real_distribution<double> number(-size, size);
    const double x = number(random), y = number(random), z = number(random);
    return {x, y, z};
}

inline Quat randomRotation(std::mt19937& random)
{
    std::normal_distribution<double> number;
    const double w = number(random), x = number(random), y = number(random), z = number(random);
    return normalized(Quat{w, x, y, z});
}

inline Mat3 randomMat3(std::mt19937& random, double size)
{
    const Vec3 a = randomVec3(random, size), b = randomVec3(random, size), c = randomVec3(random, size);
    return {{a, b, c}};
}

inline std::shared_ptr<const geometry::TetMesh> shared(geometry::TetMesh mesh)
{
    return std::make_shared<const geometry::TetMesh>(std::move(mesh));
}

inline std::string bunnyFile(int elements)
{
    return std::string(FILASOFIA_SOURCE_DIR "/assets/meshes/bunny_") + std::to_string(elements) + ".msh";
}

/// One tetrahedron with legs of length 1 along the axes.
inline geometry::TetMesh tetrahedronMesh() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}}; }

/// A box with its low corner at the origin, in n cells of six tetrahedra each (Kuhn 1960: one per order of the axes,
/// along the cell's diagonal). Nodes run fastest along z. `jitter` is the largest displacement of inner nodes as a
/// fraction of a cell.
inline geometry::TetMesh boxMesh(std::array<int, 3> n, Vec3 size, double jitter = 0.0)
{
    geometry::TetMesh mesh;
    std::mt19937 random(11);
    const Vec3 cell{size.x / n[0], size.y / n[1], size.z / n[2]};
    const auto index = [&](std::array<int, 3> p) { return (p[0] * (n[1] + 1) + p[1]) * (n[2] + 1) + p[2]; };
    for (int i = 0; i <= n[0]; ++i)
        for (int j = 0; j <= n[1]; ++j)
            for (int k = 0; k <= n[2]; ++k) {
                Vec3 p{i * cell.x, j * cell.y, k * cell.z};
                const Vec3 shift = randomVec3(random, jitter);
                const bool inner = i > 0 && i < n[0] && j > 0 && j < n[1] && k > 0 && k < n[2];
                if (inner) p += Vec3{shift.x * cell.x, shift.y * cell.y, shift.z * cell.z};
                mesh.nodes.push_back(p);
            }
    for (int i = 0; i < n[0]; ++i)
        for (int j = 0; j < n[1]; ++j)
            for (int k = 0; k < n[2]; ++k) {
                std::array<int, 3> axes{0, 1, 2};
                do {
                    std::array<int, 3> corner{i, j, k};
                    geometry::Tetrahedron t{index(corner)};
                    for (std::size_t step = 0; step < 3; ++step) {
                        ++corner[static_cast<std::size_t>(axes[step])];
                        t[step + 1] = index(corner);
                    }
                    mesh.tetrahedra.push_back(t);
                    if (geometry::signedVolume(mesh, static_cast<int>(mesh.tetrahedra.size()) - 1) < 0.0)
                        std::swap(mesh.tetrahedra.back()[2], mesh.tetrahedra.back()[3]);
                } while (std::next_permutation(axes.begin(), axes.end()));
            }
    return mesh;
}

/// The mesh and a copy of it shifted by `shift`: two pieces that are not connected.
inline geometry::TetMesh twice(const geometry::TetMesh& one, Vec3 shift)
{
    geometry::TetMesh two = one;
    const int n = static_cast<int>(one.nodes.size());
    for (const Vec3& p : one.nodes) two.nodes.push_back(p + shift);
    for (geometry::Tetrahedron t : one.tetrahedra) {
        for (int& node : t) node += n;
        two.tetrahedra.push_back(t);
    }
    return two;
}

/// The nodes for which `where` returns true.
template <class Where> std::vector<int> nodesWhere(const geometry::TetMesh& mesh, Where&& where)
{
    std::vector<int> found;
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
        if (where(mesh.nodes[i])) found.push_back(static_cast<int>(i));
    return found;
}

} // namespace filasofia
