#include "filasofia/geometry/split_solid.h"

#include "filasofia/geometry/adjacency.h"
#include "geometry/sample_meshes.h"

#include <algorithm>
#include <numeric>
#include <random>

namespace split_solid_test {

using namespace filasofia;
using namespace filasofia::geometry;

namespace {

const std::vector<Vec3> kCube{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
const std::vector<Vec3> kWedge{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
const std::vector<Vec3> kPyramid{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}};

} // namespace

TEST_CASE("every numbering of a solid gives tetrahedra of positive volume that fill it, cut through the lowest numbers")
{
    struct Case {
        Solid kind;
        std::vector<Vec3> nodes;
        std::size_t parts;
        double volume;
    };
    for (const auto& [kind, at, parts, volume] : {Case{Solid::Hexahedron, kCube, 6, 1.0},
                                                  {Solid::Prism, kWedge, 3, 0.5},
                                                  {Solid::Pyramid, kPyramid, 2, 1.0 / 3}}) {
        std::vector<std::int64_t> numbers(at.size());
        std::iota(numbers.begin(), numbers.end(), 0);
        std::mt19937 random(1);
        for (int pass = 0; pass < 300; ++pass) {
            std::shuffle(numbers.begin(), numbers.end(), random);
            std::vector<std::array<std::int64_t, 4>> out;
            splitSolid(kind, numbers, [&](const auto& part) { out.push_back(part); });
            CHECK(out.size() == parts);
            TetMesh mesh;
            mesh.nodes.resize(at.size());
            for (std::size_t i = 0; i < at.size(); ++i) mesh.nodes[static_cast<std::size_t>(numbers[i])] = at[i];
            double sum = 0.0;
            for (const auto& [a, b, c, d] : out) {
                mesh.tetrahedra.push_back(
                    {static_cast<int>(a), static_cast<int>(b), static_cast<int>(c), static_cast<int>(d)});
                const double each = signedVolume(mesh, static_cast<int>(mesh.tetrahedra.size()) - 1);
                CHECK(each > 0.1);
                sum += each;
            }
            CHECK(sum == Approx(volume));
            CHECK_NOTHROW(check(mesh, "solid"));
            // An edge across a square has the lowest number of the four corners of that square.
            for (const auto& [a, b] : edges(mesh)) {
                const Vec3 p = mesh.nodes[static_cast<std::size_t>(a)], q = mesh.nodes[static_cast<std::size_t>(b)];
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    const Vec3 d = q - p;
                    const bool square = kind != Solid::Pyramid || axis == 2;
                    if (!square || std::abs(d[axis]) > 1e-9 ||
                        std::abs(std::abs(d.x) + std::abs(d.y) + std::abs(d.z) - 2) > 1e-9)
                        continue;
                    if (kind == Solid::Prism && axis == 2) continue; // its triangles
                    for (std::size_t i = 0; i < at.size(); ++i)
                        if (std::abs(at[i][axis] - p[axis]) < 1e-9) CHECK(numbers[i] >= std::min(a, b));
                }
            }
        }
    }
}

} // namespace split_solid_test
