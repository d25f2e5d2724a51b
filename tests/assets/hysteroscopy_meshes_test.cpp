#include "assets/hysteroscopy_assets.h"

#include "filasofia/geometry/adjacency.h"

namespace hysteroscopy_meshes_test {

using namespace filasofia;
using namespace filasofia::geometry;

namespace {

constexpr double kMillimetre = 1e-3;
constexpr double kScopeRadius = 2.5 * kMillimetre;
constexpr double kWorstQuality = 0.2; // [-] stated in assets/README.md
constexpr double kRelief = 0.45e-3;   // [m] largest height of the drawn surface's folds and bumps
constexpr const char* kUteri[] = {"uterus_1702", "uterus_5000", "uterus_12000"};

void checkTets(const TetMesh& mesh, const std::string& name)
{
    CAPTURE(name);
    CHECK(connectedComponents(mesh).count == 1);
    double worst = 1.0;
    for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t) {
        REQUIRE(signedVolume(mesh, t) > 0.0);
        worst = std::min(worst, quality(mesh, t));
    }
    CHECK(worst >= kWorstQuality);
    CHECK(isClosedManifold(extractSurface(mesh).mesh));
}

/// V - E + F of a closed surface; 2 for any deformed ball.
int eulerNumber(const TriangleMesh& closed)
{
    return static_cast<int>(closed.vertices.size()) - static_cast<int>(closed.triangles.size()) / 2;
}

Vec3 nodeMean(const TetMesh& mesh, const std::vector<int>& nodes)
{
    Vec3 sum;
    for (int node : nodes) sum += mesh.nodes[node];
    return sum / static_cast<double>(nodes.size());
}

} // namespace

TEST_CASE("each uterus has as many tetrahedra as its name says, and none is bad")
{
    const int wanted[] = {1702, 5000, 12000};
    for (int i = 0; i < 3; ++i) {
        const TetMesh mesh = tets(kUteri[i]);
        checkTets(mesh, kUteri[i]);
        CHECK(static_cast<double>(mesh.tetrahedra.size()) == Approx(wanted[i]).epsilon(0.01));
        CHECK(volumeOf(mesh) == Approx(56.9e-6).epsilon(0.01)); // the same organ in every resolution
        const TriangleMesh skin = extractSurface(mesh).mesh;
        CHECK(eulerNumber(skin) == 2); // one cavity open to the outside: a dented ball, without tunnel and void
        const Box box = boundsOf(skin);
        CHECK(box.high.y - box.low.y == Approx(75.0 * kMillimetre).margin(1.0 * kMillimetre));
        CHECK(box.high.x - box.low.x == Approx(53.0 * kMillimetre).margin(1.5 * kMillimetre));
    }
}

TEST_CASE(
    "the scope's way from the external os into the cavity is open but for the canal, which is to dilate as stated")
{
    const auto known = facts("uterus.json");
    const double fundus = toVec3(known["fundusInside"]).y;
    for (const auto& entry : known["meshes"]) {
        const TriangleMesh skin = extractSurface(tets(entry["name"])).mesh;
        CAPTURE(entry["name"].get<std::string>());
        const Surroundings wall(skin);
        for (double y = -10.0 * kMillimetre; y < fundus - 1.0 * kMillimetre; y += 0.5 * kMillimetre)
            REQUIRE_FALSE(wall.holds({0, y, 0}));
        CHECK(wall.holds({0, fundus + 2.0 * kMillimetre, 0}));

        const double freeRadius = entry["freeRadius"], narrowUpTo = entry["narrowUpTo"];
        CHECK(freeRadius >= 1.6 * kMillimetre); // the canal dilates by 0.9 mm at most
        CHECK(narrowUpTo <= 31.0 * kMillimetre);
        for (double y = 0.0; y < narrowUpTo; y += 0.25 * kMillimetre)
            REQUIRE(wall.distanceTo({0, y, 0}) >= freeRadius - 0.02 * kMillimetre);
        // Beyond that height the scope touches nothing until it is one radius from the fundus.
        for (double y = narrowUpTo; y < fundus - 1.5 * kScopeRadius; y += 0.25 * kMillimetre)
            REQUIRE(wall.distanceTo({0, y, 0}) >= kScopeRadius);
    }
}

TEST_CASE("the centreline's widths are those of the finest mesh")
{
    const Surroundings wall(extractSurface(tets("uterus_12000")).mesh);
    const auto known = facts("uterus.json");
    CHECK(known["centreline"].size() >= 25);
    double last = -1.0;
    for (const auto& point : known["centreline"]) {
        const Vec3 at = toVec3(point["at"]);
        const double width = point["halfWidth"], depth = point["halfDepth"], gap = 0.35 * kMillimetre;
        CAPTURE(at.y);
        CHECK(at.y > last);
        last = at.y;
        for (double side : {-1.0, 1.0}) {
            CHECK(wall.distanceTo(at + Vec3{side * width, 0, 0}) < gap);
            CHECK(wall.distanceTo(at + Vec3{0, 0, side * depth}) < gap);
        }
    }
    const Vec3 os = toVec3(known["internalOs"]);
    CHECK(wall.distanceTo(os) == Approx(known["internalOsHalfAxes"][1].get<double>()).margin(0.1 * kMillimetre));
    for (const auto& ostium : known["ostia"]) {
        const Vec3 at = toVec3(ostium["at"]), into = toVec3(ostium["into"]);
        CHECK(length(into) == Approx(1.0).margin(1e-3));
        CHECK_FALSE(wall.holds(at));
        CHECK(wall.holds(at + 4.0 * kMillimetre * into)); // a blind funnel
    }
}

TEST_CASE("every site for a polyp lies on the lining, its normal points into the cavity, and the cavity is free as far "
          "as stated")
{
    const auto sites = facts("uterus.json")["sites"];
    CHECK(sites.size() >= 200);
    const Surroundings lining(triangles("uterus_lining.obj"));
    for (const char* name : kUteri) {
        CAPTURE(name);
        const Surroundings wall(extractSurface(tets(name)).mesh);
        int perWall[5] = {};
        for (const auto& site : sites) {
            const Vec3 at = toVec3(site["at"]), normal = toVec3(site["normal"]);
            const double free = site["free"];
            CAPTURE(at.x, at.y, at.z);
            REQUIRE(length(normal) == Approx(1.0).margin(1e-3));
            REQUIRE(lining.distanceTo(at) < kRelief);
            REQUIRE(wall.distanceTo(at) < 0.8 * kMillimetre);
            REQUIRE_FALSE(wall.holds(at + 0.5 * free * normal));
            REQUIRE(wall.holds(at - 2.0 * kMillimetre * normal));
            REQUIRE(free > 4.0 * kMillimetre);
            const std::string side = site["wall"];
            constexpr const char* kSides[] = {"anterior", "posterior", "left", "right", "fundus"};
            const auto found = std::find(std::begin(kSides), std::end(kSides), side);
            REQUIRE(found != std::end(kSides));
            ++perWall[found - std::begin(kSides)];
        }
        for (int count : perWall) CHECK(count >= 10);
    }
}

TEST_CASE("the drawn uterus is closed, is divided into lining and serosa, and lies near the tetrahedra")
{
    const TriangleMesh whole = triangles("uterus.obj");
    CHECK(isClosedManifold(whole));
    CHECK(eulerNumber(whole) == 2);
    CHECK(whole.uv.size() == whole.vertices.size());
    CHECK(volumeInside(whole) == Approx(56.9e-6).epsilon(0.01));
    CHECK(triangles("uterus_lining.obj").triangles.size() + triangles("uterus_serosa.obj").triangles.size() ==
          whole.triangles.size());

    for (const nlohmann::json& entry : listed("uterus.json", "meshes")) {
        CAPTURE(entry["name"].get<std::string>());
        const Surroundings wall(extractSurface(tets(entry["name"])).mesh);
        const double bound = std::max(entry["gapInHollow"].get<double>(), entry["gapOutside"].get<double>()) + 1e-5;
        int far = 0;
        for (Vec3 v : whole.vertices) {
            const double gap = wall.distanceTo(v);
            REQUIRE(gap < bound);
            far += gap > 1.0 * kMillimetre;
        }
        CHECK(far <= 0.01 * static_cast<double>(whole.vertices.size())); // the ends of the ostia and the tubes' stumps
    }
}

TEST_CASE("each polyp stands on its base, has the stated size, and the drawn one lies near the tetrahedra")
{
    const auto known = facts("polyps.json");
    const double root = known["root"];
    CHECK(known["polyps"].size() >= 6);
    double smallest = 1.0, largest = 0.0;
    for (const auto& entry : known["polyps"]) {
        const std::string name = entry["name"];
        const TetMesh mesh = tets(name);
        checkTets(mesh, name);
        CHECK(mesh.tetrahedra.size() >= 150);
        CHECK(mesh.tetrahedra.size() <= 600);

        std::vector<int> low;
        for (int i = 0; i < static_cast<int>(mesh.nodes.size()); ++i)
            if (mesh.nodes[i].y <= 0.0) low.push_back(i);
        CHECK(low == entry["base"].get<std::vector<int>>());
        CHECK(low.size() >= 8);
        const double foot = entry["footRadius"];
        CHECK(length(nodeMean(mesh, low) - Vec3{0, -0.7 * root, 0}) < 0.6 * kMillimetre); // around the origin
        CHECK(boundsOf(extractSurface(mesh).mesh).low.y == Approx(-root).margin(1e-7));

        const TriangleMesh seen = triangles(name + ".obj");
        CHECK(isClosedManifold(seen));
        CHECK(volumeInside(seen) == Approx(entry["volume"].get<double>()).epsilon(0.01));
        CHECK(volumeOf(mesh) == Approx(volumeInside(seen)).epsilon(0.05));
        const Box box = boundsOf(seen);
        CHECK(box.high.y == Approx(entry["height"].get<double>()).margin(1e-6));
        CHECK(box.high.x - box.low.x == Approx(entry["width"].get<double>()).margin(1e-6));
        CHECK(box.high.x - box.low.x > 2.0 * foot);
        const double size = std::max(box.high.y, box.high.x - box.low.x);
        smallest = std::min(smallest, size), largest = std::max(largest, size);
        const Surroundings skin(extractSurface(mesh).mesh);
        const double gap = entry["gapOfPicture"];
        CHECK(gap < 1.6 * kMillimetre);
        for (Vec3 v : seen.vertices) REQUIRE(skin.distanceTo(v) < gap + 1e-5);
    }
    CHECK(smallest < 8.0 * kMillimetre);
    CHECK(largest > 18.0 * kMillimetre);
    CHECK(largest < 22.0 * kMillimetre);
}

TEST_CASE("at each of its sites a polyp stands in the cavity, with only its foot in the wall")
{
    const auto sites = facts("uterus.json")["sites"];
    const Surroundings wall(extractSurface(tets("uterus_1702")).mesh);
    for (const nlohmann::json& entry : listed("polyps.json", "polyps")) {
        const TetMesh polyp = tets(entry["name"]);
        const double foot = 0.4 * entry["height"].get<double>();
        CAPTURE(entry["name"].get<std::string>());
        CHECK(entry["sites"].size() >= 8);
        int last = -1;
        for (int index : entry["sites"]) {
            REQUIRE(index > last);
            REQUIRE(index < static_cast<int>(sites.size()));
            last = index;
            const Vec3 at = toVec3(sites[index]["at"]), y = toVec3(sites[index]["normal"]);
            const Vec3 x = toVec3(sites[index]["across"]), z = cross(x, y);
            REQUIRE(std::abs(dot(x, y)) < 1e-3);
            REQUIRE(length(x) == Approx(1.0).margin(1e-3));
            bool rooted = true, free = true;
            for (Vec3 v : polyp.nodes) {
                const Vec3 placed = at + v.x * x + v.y * y + v.z * z;
                if (v.y > foot) free = free && !wall.holds(placed);
                if (v.y < -0.9 * kMillimetre && std::hypot(v.x, v.z) < 1.5 * kMillimetre)
                    rooted = rooted && wall.holds(placed);
            }
            REQUIRE(free);
            REQUIRE(rooted);
        }
    }
}

TEST_CASE("the myoma stands on its base, and its tetrahedra are fine enough for the loop that shaves it off")
{
    constexpr double kLoop = 4.8 * kMillimetre;
    const nlohmann::json entry = listed("myomas.json", "myomas").at(0);
    const TetMesh mesh = tets(entry["name"]);
    checkTets(mesh, entry["name"]);
    CHECK(eulerNumber(extractSurface(mesh).mesh) == 2);
    std::vector<int> low;
    for (int i = 0; i < static_cast<int>(mesh.nodes.size()); ++i)
        if (mesh.nodes[i].y <= 0.0) low.push_back(i);
    CHECK(low == entry["base"].get<std::vector<int>>());
    const Box box = boundsOf(extractSurface(mesh).mesh);
    CHECK(box.high.y == Approx(entry["height"].get<double>()).margin(1e-6));
    CHECK(box.high.x - box.low.x == Approx(entry["width"].get<double>()).margin(1e-6));
    CHECK(box.low.y == Approx(-facts("myomas.json")["root"].get<double>()).margin(1e-7));
    CHECK(volumeOf(mesh) == Approx(entry["volume"].get<double>()).epsilon(1e-3));
    double sum = 0.0;
    int edges = 0;
    for (const Tetrahedron& corners : mesh.tetrahedra)
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t k = i + 1; k < 4; ++k, ++edges)
                sum += distance(mesh.nodes[corners[i]], mesh.nodes[corners[k]]);
    CHECK(sum / edges < 0.28 * kLoop); // prefab/wire_loop.h asks for about a quarter
}

TEST_CASE("at each of its sites the myoma lies on the front or the back wall, with its upper half in the cavity")
{
    const auto sites = facts("uterus.json")["sites"];
    const Surroundings wall(extractSurface(tets("uterus_1702")).mesh);
    const nlohmann::json entry = listed("myomas.json", "myomas").at(0);
    const TetMesh myoma = tets(entry["name"]);
    const double half = 0.5 * entry["height"].get<double>();
    int front = 0, back = 0;
    for (int index : entry["sites"]) {
        CAPTURE(index);
        const Vec3 at = toVec3(sites.at(index)["at"]), y = toVec3(sites.at(index)["normal"]);
        const Vec3 x = toVec3(sites.at(index)["across"]), z = cross(x, y);
        CHECK(std::abs(y.z) > 0.98);
        (y.z > 0.0 ? back : front) += 1;
        bool rooted = true, free = true;
        for (Vec3 v : myoma.nodes) {
            const Vec3 placed = at + v.x * x + v.y * y + v.z * z;
            if (v.y > half) free = free && !wall.holds(placed);
            if (v.y < -0.9 * kMillimetre && std::hypot(v.x, v.z) < 1.5 * kMillimetre)
                rooted = rooted && wall.holds(placed);
        }
        CHECK(free);
        CHECK(rooted);
    }
    CHECK(front >= 5);
    CHECK(back >= 5);
}

} // namespace hysteroscopy_meshes_test
