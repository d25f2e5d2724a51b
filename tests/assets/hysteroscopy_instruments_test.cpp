#include "assets/hysteroscopy_assets.h"

#include "filasofia/geometry/mass_properties.h"

namespace hysteroscopy_instruments_test {

using namespace filasofia;
using namespace filasofia::geometry;

namespace {

constexpr double kMillimetre = 1e-3;
constexpr double kHair = 0.02 * kMillimetre;

double radiusAroundZ(const TriangleMesh& mesh)
{
    double highest = 0.0;
    for (Vec3 v : mesh.vertices) highest = std::max(highest, std::hypot(v.x, v.y));
    return highest;
}

TriangleMesh closedSurface(const std::string& file, const std::string& folder = "hysteroscopy")
{
    CAPTURE(file);
    TriangleMesh mesh = triangles(file, folder);
    CHECK(isClosedManifold(mesh));
    CHECK(massProperties(mesh, file).volume > 0.0); // also rejects a part that is inside out
    return mesh;
}

TriangleMesh collisionSurface(const std::string& file, const std::string& folder = "hysteroscopy")
{
    TriangleMesh mesh = closedSurface(file, folder);
    CHECK(mesh.triangles.size() <= 300);
    return mesh;
}

void checkSameExtent(const TriangleMesh& fine, const TriangleMesh& coarse, double within)
{
    const Box a = boundsOf(fine), b = boundsOf(coarse);
    for (int axis = 0; axis < 3; ++axis) {
        CHECK(std::abs(a.low[axis] - b.low[axis]) < within);
        CHECK(std::abs(a.high[axis] - b.high[axis]) < within);
    }
}

} // namespace

TEST_CASE("the hysteroscope has the diameter of its sheath, begins at z = 0, and lens and channel are where its JSON "
          "file says")
{
    const auto known = facts("instruments.json")["hysteroscope"];
    const double radius = known["radius"], end = known["length"];
    CHECK(radius == Approx(2.5 * kMillimetre));
    for (const auto& file : known["surfaces"]) closedSurface(file);
    const TriangleMesh sheath = triangles(known["surfaces"][0]);
    CHECK(radiusAroundZ(sheath) == Approx(radius).margin(kHair));
    const Box box = boundsOf(sheath);
    CHECK(box.low.z == Approx(0.0).margin(kHair));
    CHECK(box.high.z == Approx(end).margin(kHair));
    checkSameExtent(sheath, collisionSurface(known["collision"]), 0.3 * kMillimetre);

    const Vec3 look = toVec3(known["look"]), lens = toVec3(known["lens"]);
    CHECK(length(look) == Approx(1.0).margin(1e-5));
    CHECK(std::acos(-look.z) == Approx(30.0 * M_PI / 180.0).margin(1e-4));
    const Surroundings optic(triangles(known["surfaces"][1])), metal(sheath);
    CHECK(optic.distanceTo(lens) < 0.1 * kMillimetre);
    CHECK_FALSE(metal.holds(lens + 0.2 * kMillimetre * look)); // nothing in front of it
    CHECK(metal.holds(lens - 0.2 * kMillimetre * look));

    const Vec3 mouth = toVec3(known["channelExit"]), out = toVec3(known["channelDirection"]);
    const double wide = known["channelRadius"];
    for (double depth = 0.2 * kMillimetre; depth < 5.5 * kMillimetre; depth += 0.5 * kMillimetre) {
        CHECK_FALSE(metal.holds(mouth - depth * out));
        if (depth > 1.0 * kMillimetre)
            CHECK(metal.distanceTo(mouth - depth * out) == Approx(wide).margin(0.03 * kMillimetre));
    }
    for (const nlohmann::json& tool : listed("instruments.json", "tools")) CHECK(tool["radius"].get<double>() < wide);
}

TEST_CASE("every tool has the stated radius and length, and its jaws turn about the pivot")
{
    // The tools for suturing and laparoscopy are those of 5 Fr enlarged; others of that size pass the working channel
    // (see above).
    const auto [folder, size] =
        GENERATE(std::pair{"hysteroscopy", 1.0}, std::pair{"suturing", 3.0}, std::pair{"laparoscopy", 3.0});
    const auto tools = facts("instruments.json", folder)["tools"];
    REQUIRE(tools.size() == 3);
    const double unit = size * kMillimetre;
    for (const auto& tool : tools) {
        CAPTURE(tool["name"].get<std::string>());
        const double radius = tool["radius"], reach = tool["reach"];
        CHECK(radius == Approx(0.83 * unit));
        const TriangleMesh shaft = closedSurface(tool["shaft"], folder);
        checkSameExtent(shaft, collisionSurface(tool["shaftCollision"], folder), 0.3 * unit);
        CHECK(boundsOf(shaft).high.z == Approx(tool["length"].get<double>()).margin(kHair));
        CHECK(radiusAroundZ(shaft) < radius + 0.04 * unit); // the pin's ends stand out
        CHECK(toVec3(tool["pivot"]) == Vec3{});

        REQUIRE(tool["jaws"].size() == 2);
        for (int side : {0, 1}) {
            const auto& jaw = tool["jaws"][side];
            const TriangleMesh seen = closedSurface(jaw["surface"], folder);
            const TriangleMesh coarse = collisionSurface(jaw["collision"], folder);
            CHECK(radiusAroundZ(seen) < radius + kHair);
            CHECK(radiusAroundZ(coarse) < radius + kHair);
            CHECK(boundsOf(seen).low.z == Approx(-reach).margin(0.1 * unit));
            CHECK(boundsOf(coarse).low.z == Approx(-reach).margin(0.15 * unit));
            // The pin passes through the jaw's tang.
            const double beside = side == 0 ? 0.2 : -0.2;
            CHECK(Surroundings(seen).holds({beside * unit, 0, 0}));
            // Upper and lower jaw: a rotation about +x by a positive angle takes -z to +y.
            CHECK(toVec3(jaw["axis"]) == Vec3{side == 0 ? 1.0 : -1.0, 0, 0});
            CHECK(jaw["opensBy"].get<double>() > 0.4);
            for (Vec3 v : seen.vertices)
                if (v.z < -1.5 * unit) REQUIRE((side == 0 ? v.y : -v.y) > -0.08 * unit);
        }
    }
}

TEST_CASE("the edges of scissors lie on their blades, before the pivot, in the plane where the blades pass each other")
{
    const std::string folder = GENERATE("hysteroscopy", "suturing", "laparoscopy");
    const auto tools = facts("instruments.json", folder)["tools"];
    int edges = 0;
    for (const auto& tool : tools)
        for (const auto& jaw : tool["jaws"]) {
            if (!jaw.contains("edge")) continue;
            ++edges;
            const Surroundings seen(triangles(jaw["surface"], folder)), coarse(triangles(jaw["collision"], folder));
            const Vec3 from = toVec3(jaw["edge"][0]), to = toVec3(jaw["edge"][1]);
            CHECK(length(to - from) > 5.0 * kMillimetre);
            CHECK(to.z < from.z);
            for (double s = 0.1; s < 1.0; s += 0.1) {
                const Vec3 at = from + s * (to - from);
                CHECK(at.x == Approx(0.0).margin(1e-9));
                CHECK(seen.distanceTo(at) < 0.01 * kMillimetre);
                CHECK(coarse.distanceTo(at) < 0.2 * kMillimetre);
            }
        }
    CHECK(edges == 2);
}

TEST_CASE("every mesh of the hysteroscopy loads, and together they stay below 6 MB")
{
    std::uintmax_t bytes = 0;
    int surfaces = 0, volumes = 0;
    for (const auto& entry : std::filesystem::directory_iterator(hysteroscopyFolder())) {
        bytes += entry.file_size();
        const std::string kind = entry.path().extension();
        CAPTURE(entry.path().string());
        surfaces += kind == ".obj";
        volumes += kind == ".msh";
        if (kind == ".obj")
            CHECK_NOTHROW(loadTriangleMesh(entry.path()));
        else if (kind == ".msh")
            CHECK_NOTHROW(loadTetMesh(entry.path()));
        else
            CHECK(kind == ".json");
    }
    CHECK(bytes < 6'000'000);
    CHECK(surfaces == 28);
    CHECK(volumes == 11);
}

} // namespace hysteroscopy_instruments_test
