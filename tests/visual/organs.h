#pragma once

#include "filasofia/geometry/triangle_mesh.h"

#include <cmath>
#include <numbers>
#include <span>

/// Small meshes that look like what a surgeon sees, computed from formulas, for the pictures of the tests.
namespace filasofia::visual {

constexpr double kPi = std::numbers::pi;

/// A smooth bumpy number in about [-1, 1] for a point, with `scale` bumps per unit of length.
inline double bumps(Vec3 p, double scale)
{
    const Vec3 q = scale * p;
    return 0.5 * std::sin(1.7 * q.x + 1.3 * std::sin(1.1 * q.y) + 0.4) * std::cos(1.4 * q.y + 0.9 * q.z) +
           0.3 * std::sin(2.9 * q.z + 1.9 * q.x + 1.0) * std::cos(2.3 * q.y - 0.7) +
           0.2 * std::sin(4.3 * q.x - 3.1 * q.z);
}

/// A surface (u, v) -> point over a grid, u around (closed if `closed`), v along; its front faces the side from which u
/// runs to the right and v upwards. uv are (u, v). The vertices of a closed seam are doubled, so that uv may jump
/// there.
template <class Shape> geometry::TriangleMesh gridSurface(int columns, int rows, Shape&& shape)
{
    geometry::TriangleMesh mesh;
    for (int row = 0; row <= rows; ++row)
        for (int column = 0; column <= columns; ++column) {
            const double u = double(column) / columns, v = double(row) / rows;
            mesh.vertices.push_back(shape(u, v));
            mesh.uv.push_back({u, v});
        }
    const auto at = [&](int column, int row) { return row * (columns + 1) + column; };
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            const int a = at(column, row), b = at(column + 1, row), c = at(column + 1, row + 1),
                      d = at(column, row + 1);
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
        }
    return mesh;
}

/// A closed organ with lobes and a notch, about `radius` [m]: an octahedron split `level` times and projected. No uv.
inline geometry::TriangleMesh organ(double radius, int level)
{
    geometry::TriangleMesh mesh = sphere(1.0, level);
    for (Vec3& v : mesh.vertices) {
        const double lobes = 1.0 + 0.22 * bumps(v, 1.9) + 0.07 * bumps(v + Vec3{3, 1, 2}, 4.1);
        const double notch =
            1.0 - 0.34 * std::exp(-std::pow((v.x - 0.25 * v.z) / 0.24, 2.0)) * std::max(v.y + 0.3, 0.0);
        v = radius * lobes * notch * Vec3{1.30 * v.x, 0.92 * v.y, 1.0 * v.z};
    }
    return mesh;
}

/// The inside of a hollow organ along -Z, of `radius` and `length` [m], narrowed by folds and curved: for a camera at
/// 0.
inline geometry::TriangleMesh tubeInside(double radius, double length, int around = 72, int along = 150)
{
    return gridSurface(around, along, [&](double u, double v) {
        const double angle = 2.0 * kPi * u, z = (0.15 - v) * length;
        // Folds are crescents: deep on one side and absent on the other, each ring rotated against the previous one.
        const double ring = 7.0 * v;
        const double fold = std::exp(-std::pow((ring - std::round(ring)) / 0.075, 2.0)) *
                            (0.55 + 0.45 * std::cos(angle - 2.1 * std::round(ring)));
        const Vec3 wall{std::cos(angle), std::sin(angle), 4.0 * v};
        const double r = radius * (1.0 - 0.33 * fold + 0.05 * bumps(wall, 2.2));
        const double bend = 0.5 * radius * v * v;
        return Vec3{r * std::cos(angle) + bend, r * std::sin(angle) + 2.0 * bend * v, z};
    });
}

/// A surface of revolution about X: (x, radius) pairs from its left to its right end, radii > 0 except at closed ends.
inline geometry::TriangleMesh turned(std::span<const std::array<double, 2>> profile, int around = 48)
{
    const int rows = int(profile.size()) - 1;
    return gridSurface(rows, around, [&](double u, double v) {
        const auto& [x, r] = profile[std::size_t(std::lround(u * rows))];
        return Vec3{x, r * std::cos(2.0 * kPi * v), r * std::sin(2.0 * kPi * v)};
    });
}

/// A probe with a ball tip: the end of a palpation hook, tip at the origin, shaft along +X [m].
inline geometry::TriangleMesh probe(double length = 0.12, double radius = 0.0035)
{
    std::vector<std::array<double, 2>> profile;
    for (int i = 0; i <= 14; ++i) { // the ball
        const double angle = kPi * (1.0 - 0.84 * i / 14.0);
        profile.push_back({1.5 * radius * (1.0 + std::cos(angle)), std::max(1.5 * radius * std::sin(angle), 1e-6)});
    }
    const double start = profile.back()[0];
    for (int i = 1; i <= 6; ++i) // the neck widens into the shaft
        profile.push_back({start + 0.012 * i / 6.0, 0.72 * radius + 0.28 * radius * std::pow(i / 6.0, 2.0)});
    for (double ring : {0.25, 0.27, 0.29, 0.6, 0.62, 0.64}) // two grooves
        profile.push_back({length * ring, radius * (ring == 0.27 || ring == 0.62 ? 0.9 : 1.0)});
    profile.push_back({length, radius});
    return turned(profile);
}

/// The end of a long bone with its two condyles, shaft along +X [m].
inline geometry::TriangleMesh boneEnd(double length = 0.13, double radius = 0.011)
{
    return gridSurface(64, 48, [&](double u, double v) {
        const double angle = 2.0 * kPi * v, side = std::cos(angle);
        // Radius along the shaft: a blunt end, a wide head, a waist.
        const double cap = std::min(u / 0.16, 1.0);
        const double blunt = std::sqrt(1.0 - std::pow(1.0 - cap, 2.0));
        const double head = std::exp(-std::pow((u - 0.10) / 0.17, 2.0));
        const double condyles =
            1.0 + 1.05 * head * (0.55 + 0.45 * side * side) - 0.28 * head * (1.0 - side * side) * (angle < kPi);
        const Vec3 place{6.0 * u, side, std::sin(angle)};
        const double r = std::max(radius * condyles * blunt * (1.0 + 0.05 * bumps(place, 1.9)), 1e-6);
        return Vec3{length * u + 0.35 * length * 0.16 * (1.0 - cap) * cap - 0.01 * (1.0 - cap), r * side,
                    r * std::sin(angle)};
    });
}

/// A rounded drop of glass, about `radius` [m].
inline geometry::TriangleMesh drop(double radius)
{
    geometry::TriangleMesh mesh = sphere(1.0, 3);
    for (Vec3& v : mesh.vertices) v = radius * (1.0 + 0.12 * bumps(v, 1.1)) * v;
    return mesh;
}

/// A flat screen in the XY plane, facing +Z, middle at the origin [m].
inline geometry::TriangleMesh screen(double width, double height)
{
    return gridSurface(1, 1, [&](double u, double v) { return Vec3{width * (u - 0.5), height * (v - 0.5), 0.0}; });
}

/// A bed of folded tissue around the XZ plane, facing +Y [m].
inline geometry::TriangleMesh bed(double size, int cells = 64)
{
    return gridSurface(cells, cells, [&](double u, double v) {
        const Vec3 p{size * (u - 0.5), 0.0, size * (0.5 - v)};
        return p + Vec3{0.0, 0.05 * size * bumps((6.0 / size) * p, 1.0), 0.0};
    });
}

} // namespace filasofia::visual
