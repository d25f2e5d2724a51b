#include "filasofia/testing/fuzz_contacts.h"

#include "effort.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/testing/surface_overlap.h"

namespace fuzz_contacts_test {

using namespace filasofia;
using namespace filasofia::testing;

namespace {

PlacedSurface placed(const geometry::TriangleMesh& mesh, Vec3 at, bool closed = true)
{
    PlacedSurface surface{.triangles = mesh.triangles, .closed = closed};
    for (const Vec3 x : mesh.vertices) surface.vertices.push_back(at + x);
    return surface;
}

} // namespace

TEST_CASE("bodies that fall, are pressed and squeezed at random do nothing in silence, the same every time", "[cases]")
{
    // One scene of each kind; under the sanitizers a shorter one.
    const ContactFuzzReport report = fuzzContacts({.seed = 3, .scenes = 6, .calm = cases(1000) * 1e-3, .twice = true});
    CHECK(report.scenes == 6);
    CHECK(report.steps > cases(5000));
    CHECK(report.notFinite == 0);
    CHECK(report.undone == 0);
    CHECK(report.gained == 0);
    CHECK(report.silentInverted == 0);
    CHECK(report.hashesThatDiffer == 0);
    for (const std::string& example : report.examples) UNSCOPED_INFO(example);
    CHECK(report.silentOverlaps == 0);
}

TEST_CASE("blades, threads and needles at random do nothing in silence, the same every time", "[cases]")
{
    const ContactFuzzReport report =
        fuzzContacts({.seed = 3, .scenes = 4, .calm = cases(500) * 1e-3, .tools = true, .twice = true});
    CHECK(report.scenes == 4);
    REQUIRE(report.kinds.size() == 4);
    CHECK(report.kinds.front().name == "blade");
    CHECK(report.sound());
    for (const std::string& example : report.examples) WARN(example);
}

TEST_CASE("surfaces that contacts have lost at less depth than they follow are told")
{
    // Two sheets passed through each other by 0.65 mm, and jaws through what they held by 0.58 mm, without a flag.
    for (const auto& [seed, scene] : {std::pair{19010, 10}, {20000, 1}}) {
        CAPTURE(seed);
        const ContactFuzzReport report =
            fuzzContacts({.seed = static_cast<std::uint64_t>(seed), .scenes = 1, .first = scene});
        CHECK(report.deepest > 0.5e-3); // else it is not that scene any more
        CHECK(report.silentOverlaps == 0);
    }
}

TEST_CASE("rigid bodies that were lost in each other beside tissue part without gaining energy")
{
    // A body of 7 mm was thrown away at 6 m/s, with 43 times the energy that the scene began with.
    const ContactFuzzReport report = fuzzContacts({.seed = 2, .scenes = 1, .first = 235});
    CHECK(report.deepest > 0.5e-3); // else it is not that scene any more
    CHECK(report.gained == 0);
}

TEST_CASE("the depth of an overlap is that of the deepest point, and there is none without an overlap")
{
    const auto big = geometry::shapes::box({0.1, 0.1, 0.1}), small = geometry::shapes::box({0.02, 0.02, 0.02});
    const PlacedSurface fixed = placed(*big, {});
    CHECK_FALSE(overlapOf(fixed, placed(*small, {0.0601, 0.003, 0.002})));
    CHECK_FALSE(overlapOf(fixed, placed(*small, {0.07, 0.07, 0.07})));
    const auto side = overlapOf(fixed, placed(*small, {0.057, 0.003, 0.002})); // its face is 3 mm inside
    REQUIRE(side);
    CHECK(side->depth == Approx(0.003));
    const auto within = overlapOf(placed(*small, {0.01, 0, 0}), fixed); // wholly inside
    REQUIRE(within);
    CHECK(within->depth == Approx(0.04));
}

TEST_CASE("two bars that cross overlap by the depth of the edge between, though no corner is inside")
{
    const auto bar = geometry::shapes::box({0.1, 0.01, 0.01}), across = geometry::shapes::box({0.01, 0.01, 0.1});
    const auto crossing = overlapOf(placed(*bar, {}), placed(*across, {0.0, 0.008, 0.0}));
    REQUIRE(crossing);
    CHECK(crossing->depth == Approx(0.002));
}

TEST_CASE("a line is as deep in a closed surface as its deepest point, and so long in it")
{
    const PlacedSurface box = placed(*geometry::shapes::box({0.1, 0.1, 0.1}), {});
    const std::vector<Vec3> through{{-0.08, 0.046, 0.003}, {0.0, 0.044, 0.002}, {0.08, 0.046, 0.001}};
    const auto found = overlapOf(through, box);
    REQUIRE(found);
    CHECK(found->depth == Approx(0.006));
    CHECK(found->inside == Approx(0.1).epsilon(1e-3));
    const auto within = overlapOf(std::vector<Vec3>{{-0.01, 0, 0.001}, {0.01, 0, 0.001}, {0.02, 0, 0.001}}, box);
    REQUIRE(within);
    CHECK(within->depth == Approx(0.049));
    CHECK(within->inside == Approx(0.03));
    CHECK_FALSE(overlapOf(std::vector<Vec3>{{-0.08, 0.051, 0}, {0.08, 0.051, 0}}, box));
}

TEST_CASE("a line that goes through a sheet is as deep as its end that reaches less far")
{
    const PlacedSurface sheet = placed(*geometry::shapes::sheet(0.1, 0.1, {4, 4}), {}, false);
    const auto found =
        overlapOf(std::vector<Vec3>{{0.011, 0.03, 0.007}, {0.011, 0.01, 0.007}, {0.011, -0.004, 0.007}}, sheet);
    REQUIRE(found);
    CHECK(found->depth == Approx(0.004));
    CHECK_FALSE(overlapOf(std::vector<Vec3>{{0.011, 0.03, 0.007}, {0.011, 0.001, 0.007}}, sheet));
}

TEST_CASE("a corner that pokes through a sheet is as deep as it is beyond it")
{
    const auto sheet = geometry::shapes::sheet(0.1, 0.1, {4, 4});
    const geometry::TriangleMesh needle{.vertices = {{0, 0.02, 0}, {0.001, 0.02, 0.001}, {0, 0.02, 0.001}, {0, 0, 0}},
                                        .triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}},
                                        .uv = {}};
    const auto through = overlapOf(placed(needle, {0.011, -0.004, 0.007}), placed(*sheet, {}, false));
    REQUIRE(through);
    CHECK(through->depth == Approx(0.004));
    CHECK_FALSE(overlapOf(placed(needle, {0.011, 0.001, 0.007}), placed(*sheet, {}, false)));
}

} // namespace fuzz_contacts_test
