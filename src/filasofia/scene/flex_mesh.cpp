#include "filasofia/scene/flex_mesh.h"

#include <algorithm>
#include <cmath>

namespace filasofia::scene {
namespace {

using Cell = std::array<int, 3>;

/// From -1 to 1 along an axis.
double along(int index, int count) { return 2.0 * index / (count - 1) - 1.0; }

Vec3 halfSize(const Cell& count, Vec3 spacing)
{
    return {0.5 * spacing.x * (count[0] - 1), 0.5 * spacing.y * (count[1] - 1), 0.5 * spacing.z * (count[2] - 1)};
}

/// A point of a square on the circle through it that a square of the same half size is drawn around.
Vec3 onCircle(Vec3 p)
{
    const double reach = std::max(std::abs(p.x), std::abs(p.y)), size = std::hypot(p.x, p.y);
    return size > 0.0 ? Vec3{reach * p.x / size, reach * p.y / size, p.z} : p;
}

/// The nodes of a box's surface have their numbers in this order: both faces across z, then the rest of those across y,
/// then the rest of those across x.
class Hull {
public:
    explicit Hull(const Cell& count) : count_(count), numbers_(static_cast<std::size_t>(nodesOfGrid(count)), -1)
    {
        const auto inner = [&](int index, int axis) { return index > 0 && index < count_[axis] - 1; };
        for (const int z : {0, count[2] - 1})
            for (int x = 0; x < count[0]; ++x)
                for (int y = 0; y < count[1]; ++y) add({x, y, z});
        for (const int y : {0, count[1] - 1})
            for (int x = 0; x < count[0]; ++x)
                for (int z = 0; z < count[2]; ++z)
                    if (inner(z, 2)) add({x, y, z});
        for (const int x : {0, count[0] - 1})
            for (int y = 0; y < count[1]; ++y)
                for (int z = 0; z < count[2]; ++z)
                    if (inner(y, 1) && inner(z, 2)) add({x, y, z});
    }
    [[nodiscard]] const std::vector<Cell>& cells() const { return cells_; }
    [[nodiscard]] int numberOf(const Cell& at) const { return numbers_[placeOf(at)]; }

private:
    [[nodiscard]] std::size_t placeOf(const Cell& at) const
    {
        return (static_cast<std::size_t>(at[0]) * count_[1] + at[1]) * count_[2] + at[2];
    }
    void add(const Cell& at)
    {
        int& number = numbers_[placeOf(at)];
        if (number >= 0) return;
        number = static_cast<int>(cells_.size());
        cells_.push_back(at);
    }

    Cell count_;
    std::vector<int> numbers_;
    std::vector<Cell> cells_;
};

Vec3 projected(const Cell& at, const Cell& count, Vec3 half, FlexShape shape)
{
    Vec3 p{along(at[0], count[0]), along(at[1], count[1]), along(at[2], count[2])};
    if (shape == FlexShape::Cylinder) p = onCircle(p);
    if (shape == FlexShape::Ellipsoid) p = normalized(p);
    return {half.x * p.x, half.y * p.y, half.z * p.z};
}

/// Calls `visit` with the two triangles of every quadrangle of the surface. Those of a solid are all split alike; on a
/// surface alone, the diagonals of two sides are the other ones.
template <class Visit> void forEachTriangle(const Cell& count, bool solid, Visit&& visit)
{
    for (const int across : {2, 1, 0}) {
        const int first = across == 0 ? 1 : 0, second = across == 2 ? 1 : 2;
        for (const int side : {0, count[across] - 1})
            for (int a = 0; a + 1 < count[first]; ++a)
                for (int b = 0; b + 1 < count[second]; ++b) {
                    const auto at = [&](int i, int j) {
                        Cell cell{};
                        cell[across] = side;
                        cell[first] = a + i;
                        cell[second] = b + j;
                        return cell;
                    };
                    const bool other = !solid && ((across == 1 && side > 0) || (across == 0 && side == 0));
                    if (other) {
                        visit(at(1, 0), at(0, 0), at(0, 1));
                        visit(at(1, 0), at(0, 1), at(1, 1));
                    } else {
                        visit(at(0, 0), at(1, 0), at(1, 1));
                        visit(at(0, 0), at(0, 1), at(1, 1));
                    }
                }
    }
}

} // namespace

double nodesOfGrid(const Cell& count) { return static_cast<double>(count[0]) * count[1] * count[2]; }

double nodesOfHull(const Cell& count)
{
    const double x = count[0], y = count[1], z = count[2];
    return x * y * z - std::max(x - 2, 0.0) * std::max(y - 2, 0.0) * std::max(z - 2, 0.0);
}

FlexMesh flexSheet(const Cell& count, Vec3 spacing, bool disc)
{
    FlexMesh mesh{.corners = 3};
    const Vec3 half = halfSize(count, spacing);
    const auto node = [&](int x, int y) { return x * count[1] + y; };
    for (int x = 0; x < count[0]; ++x)
        for (int y = 0; y < count[1]; ++y) {
            Vec3 p{half.x * along(x, count[0]), half.y * along(y, count[1]), 0.0};
            // On a disc the diagonals point to its middle.
            constexpr double nothing = 1e-14; // [m]
            const bool mirrored = disc && (p.x < -nothing) != (p.y < -nothing);
            if (x + 1 < count[0] && y + 1 < count[1]) {
                const int a = node(x, y), b = node(x + 1, y), c = node(x + 1, y + 1), d = node(x, y + 1);
                const auto two = mirrored ? std::array{a, b, d, b, c, d} : std::array{a, b, c, a, c, d};
                mesh.elements.insert(mesh.elements.end(), two.begin(), two.end());
            }
            if (disc) {
                p = onCircle({along(x, count[0]), along(y, count[1]), 0.0});
                p = {half.x * p.x, half.y * p.y, 0.0};
            }
            mesh.nodes.push_back(p);
        }
    return mesh;
}

FlexMesh flexGrid(const Cell& count, Vec3 spacing)
{
    // Corners of a cell: 1 along x, 2 along y, 4 along z. All tetrahedra share the diagonal from 1 to 6 or an end of
    // it.
    constexpr std::array<std::array<int, 4>, 6> split{
        {{0, 2, 1, 6}, {0, 1, 4, 6}, {1, 2, 3, 6}, {1, 3, 7, 6}, {1, 5, 4, 6}, {1, 7, 5, 6}}};
    FlexMesh mesh;
    const Vec3 half = halfSize(count, spacing);
    const auto node = [&](int x, int y, int z) { return (x * count[1] + y) * count[2] + z; };
    for (int x = 0; x < count[0]; ++x)
        for (int y = 0; y < count[1]; ++y)
            for (int z = 0; z < count[2]; ++z) {
                mesh.nodes.push_back(
                    {half.x * along(x, count[0]), half.y * along(y, count[1]), half.z * along(z, count[2])});
                if (x + 1 == count[0] || y + 1 == count[1] || z + 1 == count[2]) continue;
                for (const auto& tetrahedron : split)
                    for (const int corner : tetrahedron)
                        mesh.elements.push_back(node(x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2)));
            }
    return mesh;
}

FlexMesh flexHull(const Cell& count, Vec3 spacing, FlexShape shape, bool solid)
{
    FlexMesh mesh{.corners = solid ? 4 : 3};
    const Hull hull(count);
    const Vec3 half = halfSize(count, spacing);
    if (solid) mesh.nodes.push_back({});
    for (const Cell& each : hull.cells()) mesh.nodes.push_back(projected(each, count, half, shape));
    const int first = solid ? 1 : 0;
    forEachTriangle(count, solid, [&](const Cell& a, const Cell& b, const Cell& c) {
        std::array<int, 3> triangle{first + hull.numberOf(a), first + hull.numberOf(b), first + hull.numberOf(c)};
        const auto at = [&](int k) { return mesh.nodes[static_cast<std::size_t>(triangle[k])]; };
        if (solid)
            mesh.elements.push_back(0);
        else if (dot(at(0), cross(at(1), at(2))) < 0.0) // all face away from the middle
            std::swap(triangle[1], triangle[2]);
        mesh.elements.insert(mesh.elements.end(), triangle.begin(), triangle.end());
    });
    return mesh;
}

FlexMesh flexFan(const geometry::TriangleMesh& surface, Vec3 origin)
{
    FlexMesh mesh;
    mesh.nodes.push_back(origin);
    mesh.nodes.insert(mesh.nodes.end(), surface.vertices.begin(), surface.vertices.end());
    for (const geometry::Triangle& each : surface.triangles) {
        const auto at = [&](int k) { return surface.vertices[static_cast<std::size_t>(each[k])]; };
        if (!(geometry::signedVolume(origin, at(0), at(1), at(2)) > 1e-15 / 6.0)) continue;
        mesh.elements.insert(mesh.elements.end(), {0, each[0] + 1, each[1] + 1, each[2] + 1});
    }
    return mesh;
}

std::vector<int> dropUnused(FlexMesh& mesh)
{
    std::vector<int> numbers(mesh.nodes.size(), -1);
    for (const int each : mesh.elements) numbers[static_cast<std::size_t>(each)] = 0;
    int next = 0;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        if (numbers[i] < 0) continue;
        mesh.nodes[static_cast<std::size_t>(next)] = mesh.nodes[i];
        numbers[i] = next++;
    }
    mesh.nodes.resize(static_cast<std::size_t>(next));
    for (int& each : mesh.elements) each = numbers[static_cast<std::size_t>(each)];
    return numbers;
}

geometry::TetMesh tetrahedraOf(const FlexMesh& mesh)
{
    geometry::TetMesh out{.nodes = mesh.nodes, .tetrahedra = {}};
    for (std::size_t i = 0; i + 3 < mesh.elements.size(); i += 4) {
        geometry::Tetrahedron each{mesh.elements[i], mesh.elements[i + 1], mesh.elements[i + 2], mesh.elements[i + 3]};
        const auto at = [&](int k) { return mesh.nodes[static_cast<std::size_t>(each[k])]; };
        if (geometry::signedVolume(at(0), at(1), at(2), at(3)) < 0.0) std::swap(each[2], each[3]);
        out.tetrahedra.push_back(each);
    }
    return out;
}

geometry::TriangleMesh trianglesOf(const FlexMesh& mesh)
{
    geometry::TriangleMesh out{.vertices = mesh.nodes, .triangles = {}, .uv = {}};
    for (std::size_t i = 0; i + 2 < mesh.elements.size(); i += 3)
        out.triangles.push_back({mesh.elements[i], mesh.elements[i + 1], mesh.elements[i + 2]});
    return out;
}

} // namespace filasofia::scene
