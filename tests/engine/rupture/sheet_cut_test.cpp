#include "filasofia/engine/rupture/check_topology.h"
#include "filasofia/engine/rupture/cut.h"
#include "filasofia/engine/rupture/pieces.h"
#include "filasofia/engine/rupture/tear.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/testing/fuzz_cuts.h"

#include "effort.h"
#include "engine/rupture/meshes.h"

namespace sheet_cut_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

constexpr double kThickness = 0.5e-3;

EditableMesh sheetOf(const geometry::TriangleMesh& mesh) { return {mesh.vertices, mesh.triangles, kThickness}; }

/// 60 x 40 mm around the origin in the plane y = 0; cells of 2.5 mm.
EditableMesh flatSheet() { return sheetOf(*geometry::shapes::sheet(0.06, 0.04, {24, 16})); }

std::string faultsOfSheet(const EditableMesh& mesh)
{
    std::string all;
    for (const TopologyViolation& v :
         checkSheetTopology(mesh.data(), {.quality = 0.25, .volume = mesh.startVolume(), .volumeTolerance = 1e-9}))
        all += std::string(name(v.fault)) + ": " + v.where + "; ";
    return all;
}

/// A vertical blade at (x, z) that moves by `way`.
RuptureReport stab(EditableMesh& mesh, BladeStroke& stroke, Vec3 at, Vec3 way, int steps)
{
    return sweep(mesh, stroke, at - Vec3{0, 0.01, 0}, at + Vec3{0, 0.01, 0}, way, steps, sheetParameters());
}

/// [m^2] per piece, by its number.
std::vector<double> areasOf(const EditableMesh& mesh)
{
    int count = 0;
    const std::vector<int> part = connectedParts(mesh.data(), count);
    std::vector<double> areas(static_cast<std::size_t>(count));
    for (std::size_t t = 0; t < part.size(); ++t)
        areas[static_cast<std::size_t>(part[t])] += restVolume(mesh.data(), static_cast<int>(t));
    return areas;
}

} // namespace

TEST_CASE("a blade through a flat sheet parts it where it went, in one step or in many")
{
    const int steps = GENERATE(1, 7, 200);
    CAPTURE(steps);
    EditableMesh mesh = flatSheet();
    BladeStroke stroke(mesh.newSheet());
    // A long blade from above in one step, or a short one that runs along the cut.
    RuptureReport report;
    if (steps == 1)
        report = sweep(mesh, stroke, {0.0113, 0.01, -0.03}, {0.0113, 0.01, 0.03}, {0, -0.02, 0}, 1, sheetParameters());
    else
        report = stab(mesh, stroke, {0.0113, 0, -0.03}, {0, 0, 0.06}, steps);
    finish(mesh, stroke, report, sheetParameters());
    CHECK(faultsOfSheet(mesh).empty());
    const std::vector<double> areas = areasOf(mesh);
    REQUIRE(areas.size() == 2);
    const auto [less, more] = std::minmax(areas[0], areas[1]);
    CHECK(std::abs(less - 0.04 * 0.0187) < 0.04 * 0.2e-3);
    CHECK(std::abs(less + more - 0.0024) < 1e-12);
    CHECK(std::abs(report.openedArea - 0.04 * kThickness) < 0.1 * 0.04 * kThickness); // it is not quite straight
    const Vec3 middle = 1.0 / report.openedArea * report.openedMoment;
    CHECK(std::abs(middle.x - 0.0113) < 0.3e-3);
    CHECK(std::abs(middle.z) < 0.3e-3);
}

TEST_CASE("a blade that stops in a sheet leaves a slit, within one triangle of its tip, and goes on from there")
{
    EditableMesh mesh = flatSheet();
    BladeStroke stroke(mesh.newSheet());
    RuptureReport report = stab(mesh, stroke, {0.0113, 0, -0.03}, {0, 0, 0.031}, 60); // 21 mm into the sheet
    finish(mesh, stroke, report, sheetParameters());
    CHECK(faultsOfSheet(mesh).empty());
    CHECK(areasOf(mesh).size() == 1);
    CHECK(report.openedArea < 0.0215 * kThickness);
    CHECK(report.openedArea > (0.021 - 0.0036) * kThickness); // a diagonal is 3.5 mm long
    BladeStroke second(stroke.sheet());
    RuptureReport rest = stab(mesh, second, {0.0113, 0, 0.001}, {0, 0, 0.03}, 60);
    finish(mesh, second, rest, sheetParameters());
    CHECK(faultsOfSheet(mesh).empty());
    CHECK(areasOf(mesh).size() == 2);
}

TEST_CASE("a blade in the middle of a sheet makes a hole with one rim")
{
    EditableMesh mesh = flatSheet();
    BladeStroke stroke(mesh.newSheet());
    RuptureReport report = stab(mesh, stroke, {-0.0112, 0, 0.003}, {0.02, 0, 0.004}, 100);
    finish(mesh, stroke, report, sheetParameters());
    CHECK(faultsOfSheet(mesh).empty());
    CHECK(areasOf(mesh).size() == 1);
    CHECK(report.openedArea > 0.8 * 0.0204 * kThickness);
    CHECK(report.copies > 4);
}

TEST_CASE("a plane through a ball's skin leaves two bowls")
{
    EditableMesh mesh = sheetOf(*geometry::shapes::sphere(0.03, 10));
    BladeStroke stroke(mesh.newSheet());
    RuptureReport report =
        sweep(mesh, stroke, {-0.04, 0.04, 0.0101}, {0.04, 0.04, 0.0101}, {0, -0.08, 0}, 100, sheetParameters());
    finish(mesh, stroke, report, sheetParameters());
    CHECK(faultsOfSheet(mesh).empty());
    const std::vector<double> areas = areasOf(mesh);
    REQUIRE(areas.size() == 2);
    const double whole = mesh.startVolume(), less = std::min(areas[0], areas[1]);
    CHECK(std::abs(less / whole - 0.5 * (1.0 - 0.0101 / 0.03)) < 0.02); // a zone's area is in proportion to its height
}

TEST_CASE("a tear in the middle of a sheet opens two edges across the stress, and at the rim it goes through")
{
    EditableMesh mesh = flatSheet();
    RuptureReport report;
    int middle = 0;
    for (int n = 0; n < mesh.nodes(); ++n)
        if (length(mesh.data().rest[n]) < length(mesh.data().rest[middle])) middle = n;
    REQUIRE(tearAt(mesh, middle, {1, 0, 0}, report));
    CHECK(report.openedFaces == 2);
    CHECK(report.copies == 1);
    CHECK(faultsOfSheet(mesh).empty());
}

TEST_CASE(
    "random cuts and tears keep shells manifolds of the same area, leave hardly any bridge and repeat bit for bit",
    "[cases]")
{
    const testing::CutFuzzReport report =
        testing::fuzzCuts({.seed = 1, .cuts = cases(1000), .meshes = testing::shellFuzzShapes()});
    CHECK(report.cuts == cases(1000));
    for (const testing::CutFuzzCount& fault : report.faults) FAIL_CHECK(fault.name << ": " << fault.count);
    for (const std::string& example : report.examples) WARN(example);
    CHECK(report.hashesThatDiffer == 0);
    CHECK(report.worstQualityShare >= 1.0 - 1e-9);
    CHECK(report.volumeDrift < 1e-6);
    CHECK(report.full > cases(70));
    CHECK(report.progressive > cases(200));
    CHECK(report.incompleteFull <= 0.001 * report.full);
    CHECK(report.incompleteProgressive <= 0.003 * report.progressive);
}

} // namespace sheet_cut_test
