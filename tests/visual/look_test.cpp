#include "little_scene.h"

#include "filasofia/geometry/mesh_file.h"

#include <cmath>
#include <numbers>

namespace look_test {

using namespace filasofia;
using namespace filasofia::visual;

namespace {

struct Look {
    double dark = 0.0;  ///< fraction of pixels that are nearly black
    double white = 0.0; ///< fraction of pixels with all three colours at full
    double red = 0.0;   ///< mean red of the others
    double green = 0.0; ///< mean green of the others
};

Look lookOf(const Image& image)
{
    Look look;
    double lit = 0.0;
    const double all = image.width * image.height;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const auto p = image.pixel(x, y);
            if (brightnessAt(image, x, y) < 8) {
                look.dark += 1.0 / all;
                continue;
            }
            lit += 1.0;
            look.red += p[0];
            look.green += p[1];
            if (p[0] > 252 && p[1] > 252 && p[2] > 252) look.white += 1.0 / all;
        }
    look.red /= lit;
    look.green /= lit;
    return look;
}

} // namespace

TEST_CASE("the bunny looks like wet tissue under an endoscope: red, glistening, not overexposed, on black")
{
    VisualBodyDef def;
    def.name = "bunny";
    def.mesh = geometry::loadTriangleMesh(FILASOFIA_SOURCE_DIR "/assets/meshes/bunny.obj");
    def.subdivision = 1;
    VisualServer server({.width = 960, .height = 720});
    server.add(def);
    addEndoscopeLook(server, boundsOf(def.mesh));
    const Image image = server.capture();
    savePng(image, FILASOFIA_BINARY_DIR "/endoscope_look.png"); // for a person to look at

    const Look look = lookOf(image);
    CHECK(look.dark > 0.3);
    CHECK(look.dark < 0.85);
    CHECK(look.white < 0.01);
    CHECK(look.red > 80);
    CHECK(look.red > 1.5 * look.green);
    int highlights = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) highlights += brightnessAt(image, x, y) > 200;
    CHECK(highlights > 200);
    CHECK(highlights < 20000);
}

TEST_CASE("the box that the look frames grows until every point is in the picture, and no further")
{
    const double half = std::tan(0.5 * 70.0 * std::numbers::pi / 180.0);
    int grew = 0;
    for (const Vec3 size : {Vec3{0.05, 0.05, 0.05}, Vec3{0.01, 0.3, 0.01}, Vec3{0.2, 0.002, 0.2}})
        for (const double aspect : {0.5, 1.0, 16.0 / 9.0})
            for (const Vec3 direction : {Vec3{0.25, 0.3, 1.0}, Vec3{0, 1, 0}, Vec3{-1, -0.2, 0.1}}) {
                const geometry::Box box{Vec3{0.1, -0.2, 0.3} - 0.5 * size, Vec3{0.1, -0.2, 0.3} + 0.5 * size};
                std::vector<Vec3> corners;
                for (int i = 0; i < 8; ++i)
                    corners.push_back({(i & 1) != 0 ? box.high.x : box.low.x, (i & 2) != 0 ? box.high.y : box.low.y,
                                       (i & 4) != 0 ? box.high.z : box.low.z});
                const geometry::Box framed = framing(box, corners, aspect, direction);
                VisualServer server({.width = 16, .height = 16});
                const Pose lens = addEndoscopeLook(server, framed, Quality::Low, direction).rig->pose();
                double most = 0.0; // [-] relative to half the height or width
                for (const Vec3 each : corners) {
                    const Vec3 seen = transform(inverse(lens), each);
                    REQUIRE(seen.z < 0.0);
                    most =
                        std::max({most, std::fabs(seen.y / seen.z) / half, std::fabs(seen.x / seen.z) / half / aspect});
                }
                CHECK(most <= 0.9601);
                if (framed == box) continue;
                ++grew;
                CHECK(most == Approx(0.96));
                CHECK(length(framed.low + framed.high - box.low - box.high) < 1e-12);
            }
    CHECK(grew > 5);
    CHECK(grew < 27);
    const geometry::TriangleMesh sphere = sphereDef().mesh; // its box has empty corners
    CHECK(framing(boundsOf(sphere), sphere.vertices, 4.0 / 3.0) == boundsOf(sphere));
    CHECK_THROWS_WITH(framing(boundsOf(sphere), sphere.vertices, 0.0), "framing: aspect must be > 0 and finite, got 0");
}

TEST_CASE("a box of any size is framed and exposed alike")
{
    double expected = 0.0;
    for (double radius : {0.05, 0.02, 0.0025, 0.5}) {
        VisualServer server({.width = 160, .height = 120});
        VisualBodyDef def = sphereDef(radius);
        def.material = TissueMaterial{.noiseScale = 8.0 / radius};
        server.add(def);
        addEndoscopeLook(server, boundsOf(def.mesh), Quality::Low);
        const double now = brightness(server.capture());
        if (expected == 0.0) expected = now;
        // Nearer than a centimetre light no longer falls off with the distance.
        CHECK(now == Approx(expected).epsilon(radius < 0.01 ? 0.15 : 0.05));
    }
}

} // namespace look_test
