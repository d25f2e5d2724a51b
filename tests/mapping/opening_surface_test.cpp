#include "filasofia/mapping/opening_surface.h"

#include "filasofia/geometry/shapes.h"
#include "filasofia/geometry/surface.h"
#include "filasofia/geometry/texture_seams.h"

#include <functional>
#include <map>
#include <set>

namespace opening_surface_test {

using namespace filasofia;
using namespace filasofia::mapping;
using geometry::TetMesh;
using geometry::Triangle;
using geometry::TriangleMesh;

namespace {

const Vec3 kSize{0.04, 0.04, 0.04};

/// A block that was parted in the plane x = 0 at the nodes for which `parted` is true: elements right of it have copies
/// of them.
struct PartedBlock {
    TetMesh rest = *geometry::shapes::block(kSize, {6, 6, 6});
    TetMesh now = rest;
    std::vector<char> right; ///< per node of `now`, whether it is on the right half only

    explicit PartedBlock(const std::function<bool(Vec3)>& parted)
    {
        right.resize(rest.nodes.size());
        std::vector<int> copy(rest.nodes.size(), -1);
        for (std::size_t n = 0; n < rest.nodes.size(); ++n) {
            const Vec3 p = rest.nodes[n];
            right[n] = p.x > 1e-9;
            if (std::abs(p.x) > 1e-9 || !parted(p)) continue;
            copy[n] = static_cast<int>(now.nodes.size());
            now.nodes.push_back(p);
        }
        right.resize(now.nodes.size(), 1);
        for (auto& nodes : now.tetrahedra) {
            Vec3 middle;
            for (const int node : nodes) middle += 0.25 * rest.nodes[node];
            if (middle.x < 0.0) continue;
            for (int& node : nodes)
                if (copy[node] >= 0) node = copy[node];
        }
    }
    [[nodiscard]] frame::Boundary boundary(const std::function<bool(Vec3)>& keep = [](Vec3) { return true; }) const
    {
        const geometry::Surface surface = geometry::extractSurface(now);
        frame::Boundary boundary{.revision = 1, .rest = now.nodes};
        std::map<std::set<int>, int> behind;
        for (const auto& nodes : now.tetrahedra)
            for (int k = 0; k < 4; ++k) behind[{nodes[(k + 1) % 4], nodes[(k + 2) % 4], nodes[(k + 3) % 4]}] = nodes[k];
        for (Triangle triangle : surface.mesh.triangles) {
            Vec3 middle;
            bool inside = true;
            for (int& corner : triangle) {
                corner = surface.nodes[corner];
                middle += (1.0 / 3.0) * now.nodes[corner];
                inside = inside && std::abs(now.nodes[corner].x) < 1e-9;
            }
            const int back = behind.at({triangle[0], triangle[1], triangle[2]});
            if (!keep(0.75 * middle + 0.25 * now.nodes[back])) continue; // the centre of the element
            boundary.triangles.push_back(triangle);
            boundary.opened.push_back(inside);
            boundary.behind.push_back(back);
        }
        return boundary;
    }
    /// Its halves moved apart, by as much as each node is above y = `from`.
    [[nodiscard]] frame::SoftBodyFrame apart(double from = -1.0) const
    {
        frame::SoftBodyFrame body;
        for (std::size_t n = 0; n < now.nodes.size(); ++n) {
            const double way = from < 0.0 ? 0.01 : std::max(0.0, now.nodes[n].y - from);
            body.positions.push_back(now.nodes[n] + Vec3{right[n] != 0 ? way : -way, 0, 0});
        }
        return body;
    }
};

/// The surface of the same block with other cells, so that the plane x = 0 cuts its triangles; `above` [m] the block.
std::shared_ptr<const MappedSurface> skin(const TetMesh& rest, double above = 0.0)
{
    TriangleMesh mesh = geometry::extractSurface(*geometry::shapes::block(kSize, {9, 7, 8})).mesh;
    for (Vec3& p : mesh.vertices) p = (1.0 + above / 0.02) * p;
    for (const Vec3& p : mesh.vertices) mesh.uv.push_back({p.x, p.y});
    return std::make_shared<const MappedSurface>(mapSurface(rest, std::move(mesh)));
}

double area(const std::vector<Vec3>& places, const std::vector<Triangle>& triangles)
{
    double sum = 0.0;
    for (const auto& [a, b, c] : triangles) sum += 0.5 * length(cross(places[b] - places[a], places[c] - places[a]));
    return sum;
}
std::vector<Vec3> placesOf(const MappedSurface& surface, const frame::SoftBodyFrame& body)
{
    std::vector<Vec3> places(surface.surface.vertices.size());
    apply(surface.map, body, places);
    return places;
}
double longestEdge(const std::vector<Vec3>& places, const std::vector<Triangle>& triangles)
{
    double longest = 0.0;
    for (const auto& [a, b, c] : triangles)
        longest = std::max(
            {longest, distance(places[a], places[b]), distance(places[b], places[c]), distance(places[c], places[a])});
    return longest;
}

} // namespace

TEST_CASE("a surface on a body that nothing has cut is unchanged")
{
    const PartedBlock block([](Vec3) { return false; });
    const auto whole = skin(block.rest);
    const auto opening = OpeningSurface::make(whole, block.rest);
    REQUIRE(opening);
    CHECK(opening->on(block.boundary()) == whole);
}

TEST_CASE("a surface is parted along the rim of a cut, and each part goes with its side")
{
    const PartedBlock block([](Vec3) { return true; });
    const auto whole = skin(block.rest);
    const auto opened = OpeningSurface::make(whole, block.rest)->on(block.boundary());
    const TriangleMesh& surface = opened->surface;
    CHECK(area(surface.vertices, surface.triangles) == Approx(6 * 0.04 * 0.04).epsilon(1e-9));
    CHECK(surface.uv.size() == surface.vertices.size());
    for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
        CHECK(surface.uv[v][0] == Approx(surface.vertices[v].x).margin(1e-12));
        CHECK(surface.uv[v][1] == Approx(surface.vertices[v].y).margin(1e-12));
    }
    const frame::SoftBodyFrame atRest{.positions = block.now.nodes};
    const auto before = placesOf(*opened, atRest);
    for (std::size_t v = 0; v < before.size(); ++v) CHECK(distance(before[v], surface.vertices[v]) < 1e-12);

    const auto places = placesOf(*opened, block.apart());
    for (std::size_t v = 0; v < places.size(); ++v) {
        const double x = surface.vertices[v].x;
        CHECK(places[v].x - x == Approx(x < -1e-9 ? -0.01 : x > 1e-9 ? 0.01 : places[v].x - x).epsilon(1e-9));
        CHECK(std::abs(std::abs(places[v].x - x) - 0.01) < 1e-11);
    }
    CHECK(longestEdge(places, surface.triangles) <=
          (1.0 + 1e-12) * longestEdge(whole->surface.vertices, whole->surface.triangles));
    CHECK(area(places, surface.triangles) == Approx(6 * 0.04 * 0.04).epsilon(1e-9));
}

TEST_CASE("a texture with seams is parted by corners as one without is by vertices")
{
    const PartedBlock block([](Vec3) { return true; });
    const auto plain = skin(block.rest);
    auto seams = std::make_shared<MappedSurface>(*plain);
    std::vector<std::array<double, 2>> ofCorners;
    for (const Triangle& t : plain->surface.triangles)
        for (const int v : t) ofCorners.push_back(plain->surface.uv[v]);
    setUvOfCorners(seams->surface, std::move(ofCorners));
    REQUIRE(perCorner(seams->surface));
    const auto one = OpeningSurface::make(plain, block.rest)->on(block.boundary());
    const auto two = OpeningSurface::make(seams, block.rest)->on(block.boundary());
    REQUIRE(one->surface.triangles.size() > plain->surface.triangles.size());
    REQUIRE(one->surface.triangles == two->surface.triangles);
    REQUIRE(perCorner(two->surface));
    for (std::size_t i = 0; i < two->surface.uv.size(); ++i)
        CHECK(two->surface.uv[i] == one->surface.uv[one->surface.triangles[i / 3][i % 3]]);
}

TEST_CASE("a slit opens down to its end and no further")
{
    const PartedBlock block([](Vec3 p) { return p.y > 1e-9; });
    const auto whole = skin(block.rest);
    const auto opened = OpeningSurface::make(whole, block.rest)->on(block.boundary());
    const TriangleMesh& surface = opened->surface;
    CHECK(area(surface.vertices, surface.triangles) == Approx(6 * 0.04 * 0.04).epsilon(1e-9));
    const auto places = placesOf(*opened, block.apart(0.0));
    double gap = 0.0;
    for (std::size_t v = 0; v < places.size(); ++v) {
        if (std::abs(surface.vertices[v].x) > 1e-9) continue;
        gap = std::max(gap, std::abs(places[v].x));
        if (surface.vertices[v].y < -0.0058) CHECK(std::abs(places[v].x) < 1e-9); // a triangle below the tip
    }
    CHECK(gap == Approx(0.02).epsilon(0.01));
    // No triangle of the skin spans the gap: in the opened part every triangle is on one side.
    for (const Triangle& triangle : surface.triangles) {
        double low = 1.0, high = -1.0;
        for (const int v : triangle) {
            low = std::min(low, places[v].x);
            high = std::max(high, places[v].x);
        }
        const double y = (1.0 / 3.0) * (places[triangle[0]].y + places[triangle[1]].y + places[triangle[2]].y);
        if (y > 0.0058) CHECK((high < 1e-9 || low > -1e-9));
    }
}

TEST_CASE("a surface above its body gets a strip down to the rim, even if it has none of the body's nodes")
{
    const PartedBlock block([](Vec3) { return true; });
    const auto whole = skin(block.rest, 0.5e-3);
    const auto opened = OpeningSurface::make(whole, block.rest)->on(block.boundary());
    const TriangleMesh& surface = opened->surface;
    const double size = 0.041;
    const double skins = 6 * size * size, strips = 2 * 4 * 0.04 * 0.5e-3;
    CHECK(area(surface.vertices, surface.triangles) == Approx(skins + strips).epsilon(0.002));
    const auto places = placesOf(*opened, block.apart());
    for (const Triangle& triangle : surface.triangles) {
        const bool left = places[triangle[0]].x < 0.0;
        for (const int v : triangle) CHECK((places[v].x < 0.0) == left);
    }
}

TEST_CASE("the part of a surface that was on a removed piece is gone")
{
    const PartedBlock block([](Vec3) { return true; });
    const auto opened =
        OpeningSurface::make(skin(block.rest), block.rest)->on(block.boundary([](Vec3 p) { return p.x < 0.0; }));
    const TriangleMesh& surface = opened->surface;
    CHECK(area(surface.vertices, surface.triangles) == Approx(3 * 0.04 * 0.04).epsilon(0.01));
    for (const Vec3& p : surface.vertices) CHECK(p.x < 0.0003);
    const auto places = placesOf(*opened, block.apart());
    for (std::size_t v = 0; v < places.size(); ++v)
        CHECK(distance(places[v], surface.vertices[v] - Vec3{0.01, 0, 0}) < 1e-12);
}

TEST_CASE("a surface inside a body is not its skin")
{
    const PartedBlock block([](Vec3) { return true; });
    const auto inside = std::make_shared<const MappedSurface>(mapSurface(block.rest, *geometry::shapes::sphere(0.005)));
    CHECK(OpeningSurface::make(inside, block.rest) == nullptr);
}

} // namespace opening_surface_test
