#include "filasofia/geometry/shapes.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/kuhn.h"
#include "filasofia/geometry/shape_checks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace filasofia::geometry::shapes {
namespace {

constexpr int kMaxSurfaceCells = 500; ///< [-], edges along a side: 6 million triangles at most
constexpr int kMaxBlockCells = 200;   ///< [-], cells along a side

void checkGrid(const char* shape, Vec3 size, const std::array<int, 3>& cells, int max)
{
    checkLength(shape, "size.x", size.x);
    checkLength(shape, "size.y", size.y);
    checkLength(shape, "size.z", size.z);
    constexpr const char* names[] = {"cells[0]", "cells[1]", "cells[2]"};
    for (std::size_t axis = 0; axis < 3; ++axis) checkCount(shape, names[axis], cells[axis], 1, max);
}

/// A point of a grid that fills a box around the origin.
using GridPoint = std::array<int, 3>;
Vec3 placeOf(const GridPoint& p, Vec3 size, const std::array<int, 3>& cells)
{
    const auto along = [](int i, int count, double length) { return (static_cast<double>(i) / count - 0.5) * length; };
    return {along(p[0], cells[0], size.x), along(p[1], cells[1], size.y), along(p[2], cells[2], size.z)};
}

/// Points on a circle about the y axis; a single point if the radius is 0.
struct Ring {
    double y = 0.0;      ///< [m]
    double radius = 0.0; ///< [m]
    int count = 1;       ///< number of points
};

/// The surface spanned by rings from the lowest to the highest; the first and the last are points. From one ring to the
/// next the count stays the same, changes by one per quarter, or goes from or to one point.
class Turned {
public:
    TriangleMesh mesh;

    void add(const Ring& ring)
    {
        const int start = static_cast<int>(mesh.vertices.size());
        for (int i = 0; i < ring.count; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / ring.count;
            mesh.vertices.push_back({ring.radius * std::cos(angle), ring.y, ring.radius * std::sin(angle)});
        }
        if (start > 0) span({start_, last_}, {start, ring.count});
        start_ = start;
        last_ = ring.count;
    }

private:
    struct Row {
        int start, count;
        [[nodiscard]] int at(int i) const { return start + i % count; }
    };

    /// Goes around both rings at once; the ring that lags behind gets the next edge.
    void span(Row low, Row high)
    {
        const long lows = low.count > 1 ? low.count : 0, highs = high.count > 1 ? high.count : 0;
        for (long i = 0, j = 0; i < lows || j < highs;) {
            // Cross-multiplied, so that equal angles compare equal: (2 i + 1) / lows with (2 j + 1) / highs.
            const bool stepLow = j == highs || (i < lows && (2 * i + 1) * highs <= (2 * j + 1) * lows);
            const int a = low.at(static_cast<int>(i)), b = high.at(static_cast<int>(j));
            mesh.triangles.push_back({a, b, stepLow ? low.at(static_cast<int>(++i)) : high.at(static_cast<int>(++j))});
        }
    }

    int start_ = 0, last_ = 0;
};

/// The rings of a sphere's lower half, from the pole to the equator.
std::vector<Ring> halfSphere(double radius, int quarter)
{
    std::vector<Ring> rings;
    for (int i = 0; i <= quarter; ++i) {
        const double angle = 0.5 * std::numbers::pi * i / quarter;
        rings.push_back({-radius * std::cos(angle), radius * std::sin(angle), std::max(1, 4 * i)});
    }
    return rings;
}

/// The surface of the rings and their mirror images; if `apart` > 0 [m], a band of that length lies between them.
std::shared_ptr<const TriangleMesh> mirrored(std::vector<Ring> lower, double apart)
{
    Turned turned;
    for (Ring ring : lower) turned.add({ring.y - 0.5 * apart, ring.radius, ring.count});
    if (apart == 0.0) lower.pop_back(); // both halves share one equator
    for (std::size_t i = lower.size(); i-- > 0;)
        turned.add({-lower[i].y + 0.5 * apart, lower[i].radius, lower[i].count});
    return std::make_shared<const TriangleMesh>(std::move(turned.mesh));
}

void checkOutline(const std::vector<Vec3>& corners)
{
    if (corners.size() < 3) fail("revolved: corners must have at least 3 entries, got ", corners.size());
    double area = 0.0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const auto& [x, y, z] = corners[i];
        if (!isFinite(corners[i])) fail("revolved: corners[", i, "] must be finite");
        if (x < 0.0) fail("revolved: corners[", i, "].x must be >= 0 m, got ", x);
        if (z != 0.0) fail("revolved: corners[", i, "].z must be 0 m, got ", z);
        area += cross(corners[i], corners[(i + 1) % corners.size()]).z / 2.0;
    }
    if (!(area > 0.0)) fail("revolved: corners must go counter-clockwise around an area > 0 m^2, got ", area);
}

} // namespace

std::shared_ptr<const TriangleMesh> box(Vec3 size, std::array<int, 3> cells)
{
    checkGrid("box", size, cells, kMaxSurfaceCells);
    TriangleMesh mesh;
    std::map<GridPoint, int> numbers;
    const auto vertex = [&](const GridPoint& p) {
        const auto [at, fresh] = numbers.try_emplace(p, static_cast<int>(mesh.vertices.size()));
        if (fresh) mesh.vertices.push_back(placeOf(p, size, cells));
        return at->second;
    };
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t right = (axis + 1) % 3, up = (axis + 2) % 3;
        for (const bool high : {false, true})
            for (int i = 0; i < cells[right]; ++i)
                for (int j = 0; j < cells[up]; ++j) {
                    GridPoint p{};
                    p[axis] = high ? cells[axis] : 0;
                    const auto corner = [&](int di, int dj) {
                        p[right] = i + di;
                        p[up] = j + dj;
                        return vertex(p);
                    };
                    const int a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
                    mesh.triangles.push_back(high ? Triangle{a, b, c} : Triangle{a, c, b});
                    mesh.triangles.push_back(high ? Triangle{a, c, d} : Triangle{a, d, c});
                }
    }
    return std::make_shared<const TriangleMesh>(std::move(mesh));
}

std::shared_ptr<const TriangleMesh> sphere(double radius, int quarter)
{
    checkLength("sphere", "radius", radius);
    checkCount("sphere", "quarter", quarter, 1, kMaxSurfaceCells);
    return mirrored(halfSphere(radius, quarter), 0.0);
}

std::shared_ptr<const TriangleMesh> ellipsoid(Vec3 halfAxes, int quarter)
{
    checkLength("ellipsoid", "halfAxes.x", halfAxes.x);
    checkLength("ellipsoid", "halfAxes.y", halfAxes.y);
    checkLength("ellipsoid", "halfAxes.z", halfAxes.z);
    checkCount("ellipsoid", "quarter", quarter, 1, kMaxSurfaceCells);
    TriangleMesh mesh = *sphere(1.0, quarter);
    for (Vec3& v : mesh.vertices) v = {halfAxes.x * v.x, halfAxes.y * v.y, halfAxes.z * v.z};
    return std::make_shared<const TriangleMesh>(std::move(mesh));
}

std::shared_ptr<const TriangleMesh> capsule(double radius, double length, int quarter)
{
    checkLength("capsule", "radius", radius);
    checkLength("capsule", "length", length);
    checkCount("capsule", "quarter", quarter, 1, kMaxSurfaceCells);
    return mirrored(halfSphere(radius, quarter), length);
}

std::shared_ptr<const TriangleMesh> cylinder(double radius, double length, int quarter)
{
    checkLength("cylinder", "radius", radius);
    checkLength("cylinder", "length", length);
    checkCount("cylinder", "quarter", quarter, 1, kMaxSurfaceCells);
    return mirrored({{0.0, 0.0, 1}, {0.0, radius, 4 * quarter}}, length);
}

std::shared_ptr<const TriangleMesh> revolved(const std::vector<Vec3>& corners, int sides)
{
    checkOutline(corners);
    checkCount("revolved", "sides", sides, 3, kMaxSurfaceCells);
    TriangleMesh mesh;
    const std::size_t count = corners.size();
    std::vector<int> numbers; // vertices, side by side; a corner on the axis has one
    for (int side = 0; side < sides; ++side)
        for (std::size_t k = 0; k < count; ++k) {
            const auto [radius, y, z] = corners[k];
            const double angle = 2.0 * std::numbers::pi * side / sides;
            const bool again = radius == 0.0 && side > 0;
            numbers.push_back(again ? numbers[k] : static_cast<int>(mesh.vertices.size()));
            if (!again) mesh.vertices.push_back({radius * std::sin(angle), y, radius * std::cos(angle)});
        }
    for (std::size_t side = 0; side < static_cast<std::size_t>(sides); ++side)
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t here = side * count, next = (side + 1) % static_cast<std::size_t>(sides) * count;
            const std::size_t up = (k + 1) % count;
            const int a = numbers[here + k], b = numbers[next + k], c = numbers[next + up], d = numbers[here + up];
            if (a != b) mesh.triangles.push_back({a, b, c});
            if (c != d) mesh.triangles.push_back({a, c, d});
        }
    return std::make_shared<const TriangleMesh>(std::move(mesh));
}

std::shared_ptr<const TriangleMesh> sheet(double width, double depth, std::array<int, 2> cells, bool printed)
{
    checkLength("sheet", "width", width);
    checkLength("sheet", "depth", depth);
    checkCount("sheet", "cells[0]", cells[0], 1, kMaxSurfaceCells);
    checkCount("sheet", "cells[1]", cells[1], 1, kMaxSurfaceCells);
    TriangleMesh mesh;
    const std::array<int, 3> grid{cells[0], 1, cells[1]};
    for (int i = 0; i <= cells[0]; ++i)
        for (int k = 0; k <= cells[1]; ++k) {
            const Vec3 place = placeOf({i, 0, k}, {width, 0.0, depth}, grid);
            mesh.vertices.push_back({place.x, 0.0, place.z});
            if (printed) mesh.uv.push_back({place.x / width + 0.5, 0.5 - place.z / depth});
        }
    for (int i = 0; i < cells[0]; ++i)
        for (int k = 0; k < cells[1]; ++k) {
            const int a = i * (cells[1] + 1) + k, b = a + cells[1] + 1;
            mesh.triangles.insert(mesh.triangles.end(), {{a, b + 1, b}, {a, a + 1, b + 1}});
        }
    return std::make_shared<const TriangleMesh>(std::move(mesh));
}

std::shared_ptr<const TetMesh> block(Vec3 size, std::array<int, 3> cells)
{
    checkGrid("block", size, cells, kMaxBlockCells);
    checkTetrahedra("block", 6LL * cells[0] * cells[1] * cells[2]);
    TetMesh mesh;
    const auto node = [&](const GridPoint& p) { return (p[0] * (cells[1] + 1) + p[1]) * (cells[2] + 1) + p[2]; };
    for (int i = 0; i <= cells[0]; ++i)
        for (int j = 0; j <= cells[1]; ++j)
            for (int k = 0; k <= cells[2]; ++k) mesh.nodes.push_back(placeOf({i, j, k}, size, cells));
    for (int i = 0; i < cells[0]; ++i)
        for (int j = 0; j < cells[1]; ++j)
            for (int k = 0; k < cells[2]; ++k) addKuhnCell(mesh, {i, j, k}, node);
    return std::make_shared<const TetMesh>(std::move(mesh));
}

} // namespace filasofia::geometry::shapes
