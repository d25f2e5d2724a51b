#include "filasofia/geometry/mass_properties.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/box.h"
#include "filasofia/geometry/tet_mesh.h"

#include <algorithm>

namespace filasofia::geometry {
namespace {

/// [-] A surface is flat if its volume is less than this fraction of the cube of its size; rounding errors are smaller.
constexpr double kFlat = 1e-12;

/// What a user can do about a surface that is not closed or does not face outwards.
constexpr std::string_view kRemedy =
    "; 'filasofia mesh FILE -o NAME.msh --parts FOLDER' repairs it, as FOLDER/NAME_collision.obj";

/// Integrals of 1, p and p p^T over the inside, with p relative to `origin`. The divergence theorem turns them into
/// integrals over the triangles (Mirtich 1996), which for polynomials are those over the signed tetrahedra between
/// origin and triangle.
struct Integrals {
    double volume = 0.0;
    Vec3 first;
    Mat3 second;
};

Integrals integrate(const TriangleMesh& mesh, Vec3 origin)
{
    Integrals sum;
    for (const auto& [i, j, k] : mesh.triangles) {
        const Vec3 a = mesh.vertices[i] - origin, b = mesh.vertices[j] - origin, c = mesh.vertices[k] - origin;
        const double sixfold = dot(a, cross(b, c));
        const Vec3 s = a + b + c;
        sum.volume += sixfold / 6.0;
        sum.first += sixfold / 24.0 * s;
        sum.second += sixfold / 120.0 * (outer(a, a) + outer(b, b) + outer(c, c) + outer(s, s));
    }
    return sum;
}

bool positiveDefinite(const Mat3& m) // Sylvester's criterion
{
    return m[0].x > 0.0 && m[0].x * m[1].y - m[0].y * m[1].x > 0.0 && determinant(m) > 0.0;
}

} // namespace

void checkClosed(const TriangleMesh& mesh, std::string_view name)
{
    struct Edge {
        int low, high;
        bool rising;
    };
    std::vector<Edge> edges;
    edges.reserve(3 * mesh.triangles.size());
    for (const Triangle& t : mesh.triangles)
        for (std::size_t side = 0; side < 3; ++side) {
            const int from = t[side], to = t[(side + 1) % 3];
            edges.push_back({std::min(from, to), std::max(from, to), from < to});
        }
    std::ranges::sort(edges,
                      [](const Edge& a, const Edge& b) { return a.low != b.low ? a.low < b.low : a.high < b.high; });
    for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
        int there = 0, back = 0;
        for (; end < edges.size() && edges[end].low == edges[begin].low && edges[end].high == edges[begin].high; ++end)
            ++(edges[end].rising ? there : back);
        const auto [low, high, rising] = edges[begin];
        if (there + back == 1)
            fail(name, ": must be a closed surface; the edge between vertices ", low, " and ", high,
                 " has one triangle only", kRemedy);
        if (there != back)
            fail(name, ": must be a closed surface; the triangles at the edge between vertices ", low, " and ", high,
                 " are not oriented alike", kRemedy);
    }
}

double enclosedVolume(const TriangleMesh& mesh)
{
    double volume = 0.0;
    for (const Triangle& t : mesh.triangles)
        volume += signedVolume(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]], mesh.vertices[0]);
    return -volume;
}

MassProperties massProperties(const TriangleMesh& mesh, std::string_view name)
{
    checkClosed(mesh, name);
    Box box;
    for (const Triangle& t : mesh.triangles)
        for (int vertex : t) box = merged(box, mesh.vertices[vertex]);
    const double size = length(box.high - box.low);

    // Integrate relative to a point of the surface: far from the world's origin everything would cancel.
    const Vec3 origin = mesh.vertices[mesh.triangles.front().front()];
    const Integrals about = integrate(mesh, origin);
    if (about.volume < -kFlat * size * size * size)
        fail(name, ": must not be inside out; its volume is ", about.volume,
             " m^3; triangles must be counter-clockwise seen from outside", kRemedy);
    if (!(about.volume > kFlat * size * size * size))
        fail(name, ": must not be flat; its volume must be > 0 m^3, got ", about.volume);
    const Vec3 centre = origin + about.first / about.volume;

    // Integrate again relative to the centre instead of using the parallel axis theorem, which takes the difference of
    // large numbers.
    const Mat3 second = integrate(mesh, centre).second;
    if (!positiveDefinite(second))
        fail(name, ": must be the surface of one body; a part of it is inside out and lies outside the rest", kRemedy);
    return {about.volume, centre, trace(second) * Mat3::identity() - second};
}

} // namespace filasofia::geometry
