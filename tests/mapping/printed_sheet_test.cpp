#include "filasofia/geometry/shapes.h"
#include "filasofia/mapping/printed_sheet.h"

#include <catch2/catch.hpp>

namespace printed_sheet_test {
using namespace filasofia;
using namespace filasofia::mapping;

TEST_CASE("a print stays where it is on a sheet that is cut: at old nodes, at new ones, and at those that were moved")
{
    geometry::TriangleMesh sheet = *geometry::shapes::sheet(0.1, 0.2, {5, 7});
    const auto expected = [](Vec3 p) { return std::array{p.x / 0.1 + 0.5, 0.5 - p.z / 0.2}; };
    for (const Vec3& each : sheet.vertices) sheet.uv.push_back(expected(each));
    PrintedSheet print(sheet);
    frame::Boundary boundary{.revision = 1, .triangles = sheet.triangles, .rest = sheet.vertices};
    boundary.opened.assign(boundary.triangles.size(), 0);
    for (int turn = 0; turn < 3; ++turn) {
        if (turn > 0) { // a new node in a triangle, and another place for an old one
            boundary.rest.push_back({0.013 * turn, 0, -0.021 * turn});
            boundary.triangles.push_back({0, 1, static_cast<int>(boundary.rest.size()) - 1});
            boundary.opened.push_back(0);
            boundary.rest[10] += Vec3{2e-3, 0, 1e-3};
        }
        MappedSurface surface = mapBoundary(boundary, false);
        print.print(surface);
        REQUIRE(surface.surface.uv.size() == surface.surface.vertices.size());
        for (std::size_t v = 0; v < surface.surface.uv.size(); ++v)
            for (const std::size_t k : {0, 1})
                CHECK(surface.surface.uv[v][k] == Approx(expected(surface.surface.vertices[v])[k]).margin(1e-12));
    }
}

} // namespace printed_sheet_test
