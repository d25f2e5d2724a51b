#include "engine/collision/pair_minima.h"
#include "engine/collision/scene.h"

#include "filasofia/engine/body/collision_model.h"
#include "filasofia/engine/collision/element_pairs.h"
#include "filasofia/geometry/shapes.h"

#include <cmath>
#include <numbers>
#include <set>

namespace filasofia::engine::self_collision_test {
namespace {

/// A slab with a slit from one end to its middle, as a cut leaves it: the lips lie on each other at rest and share the
/// vertices at the slit's tip only. Cells of 5 mm, 8 mm high.
struct Slit {
    static constexpr int kCells = 8;
    static constexpr double kCell = 5e-3, kHalf = 4e-3;
    geometry::TriangleMesh mesh;
    std::vector<int> upperLip; ///< its vertices, without those of the tip

    Slit()
    {
        // The outline of the section x-z, anticlockwise as seen from -y: bottom, end, top, then in along the slit.
        std::vector<Vec3> outline;
        const double length = kCells * kCell;
        for (int i = 0; i < kCells; ++i) outline.push_back({i * kCell, 0, -kHalf});
        outline.push_back({length, 0, -kHalf});
        outline.push_back({length, 0, 0}); // lower lip, inwards
        for (int i = kCells - 1; i >= kCells / 2; --i) outline.push_back({i * kCell, 0, 0});
        const std::size_t tip = outline.size() - 1;
        for (int i = kCells / 2 + 1; i <= kCells; ++i) outline.push_back({i * kCell, 0, 0}); // upper lip, outwards
        const std::size_t lipEnd = outline.size();
        for (int i = kCells; i >= 0; --i) outline.push_back({i * kCell, 0, kHalf});
        const int n = static_cast<int>(outline.size());
        for (const double y : {-0.5 * kCell, 0.5 * kCell})
            for (const Vec3 p : outline) mesh.vertices.push_back(p + Vec3{0, y, 0});
        for (int i = 0; i < n; ++i) {
            const int k = (i + 1) % n;
            mesh.triangles.push_back({i, i + n, k + n});
            mesh.triangles.push_back({i, k + n, k});
        }
        for (std::size_t i = tip + 1; i < lipEnd; ++i)
            for (const int side : {0, n}) upperLip.push_back(static_cast<int>(i) + side);
        close(n);
    }

private:
    /// Both ends in y: fans around a vertex in the middle of the lower and of the upper half.
    void close(int n)
    {
        for (const int side : {0, n}) {
            const double y = mesh.vertices[static_cast<std::size_t>(side)].y;
            const int centre = static_cast<int>(mesh.vertices.size());
            mesh.vertices.push_back({0.25 * kCells * kCell, y, 0});
            for (int i = 0; i < n; ++i) {
                const int a = side + i, b = side + (i + 1) % n;
                if (side == 0)
                    mesh.triangles.push_back({centre, a, b});
                else
                    mesh.triangles.push_back({centre, b, a});
            }
        }
    }
};

/// A point's place above a wedge: two bodies in one mesh, so that both are the same surface.
struct WedgeOverBox {
    Scene scene;
    int corner = 0;                                     ///< a vertex of the box's upper face
    static constexpr double kGap = 0.3e-3, kRest = 0.1; ///< [m] the wedge's height now and at rest

    WedgeOverBox()
    {
        geometry::TriangleMesh mesh = boxMesh({0.01, 0.01, 0.01}, 2);
        const int box = static_cast<int>(mesh.vertices.size());
        for (int v = 0; v < box; ++v)
            if (length(mesh.vertices[static_cast<std::size_t>(v)] - Vec3{0, 0, 0.01}) < 1e-9) corner = v;
        // Its lower face is level, and its upper one meets it in the edge at x = -0.5 mm.
        const double back = 0.02, sharp = -0.5e-3, side = 0.02, thick = 5e-3;
        mesh.vertices.insert(mesh.vertices.end(), {{sharp, -side, 0},
                                                   {sharp, side, 0},
                                                   {back, -side, 0},
                                                   {back, side, 0},
                                                   {back, -side, thick},
                                                   {back, side, thick}});
        const auto add = [&](int a, int b, int c) { mesh.triangles.push_back({box + a, box + b, box + c}); };
        add(0, 1, 3), add(0, 3, 2); // below
        add(0, 4, 5), add(0, 5, 1); // above
        add(2, 3, 5), add(2, 5, 4);
        add(0, 2, 4), add(1, 5, 3);
        for (std::size_t v = static_cast<std::size_t>(box); v < mesh.vertices.size(); ++v) mesh.vertices[v].z += kRest;
        scene.add(mesh, {.proximity = 0.5e-3, .depth = 1e-3, .self = true});
        for (Vec3& x : scene.surfaces[0].x)
            if (x.z >= kRest) x.z += 0.01 + kGap - kRest;
    }
};

/// A lump that is bent over itself and crumpled.
void addCrumpled(const CollisionOptions& options, double roughness, std::mt19937& random, Scene& scene)
{
    const int lump = scene.add(lumpMesh(0.8, 10, roughness, random), options);
    for (Vec3& x : scene.surfaces[static_cast<std::size_t>(lump)].x) {
        const double turn = 2.2 * x.x;
        x = Vec3{std::sin(turn) * (0.4 + x.z), x.y, std::cos(turn) * (0.4 + x.z)} + randomVector(random, 0.05);
    }
}

std::set<std::uint64_t> featuresOf(const std::vector<Proximity>& found)
{
    std::set<std::uint64_t> out;
    for (const Proximity& each : found) out.insert(each.feature);
    return out;
}

} // namespace

TEST_CASE("the lips of a slit collide with each other, though they lie on each other at rest")
{
    const Slit slit;
    Scene scene;
    scene.add(slit.mesh, {.proximity = 0.5e-3, .depth = 0.6e-3, .self = true});
    REQUIRE(scene.surfaces[0].shape->closed);
    const auto across = [](const Proximity& p) { return std::fabs(p.normal.z) > 0.99; };
    // As insets leave it: the lips are a little apart.
    for (const int v : slit.upperLip) scene.surfaces[0].x[static_cast<std::size_t>(v)].z += 0.2e-3;
    scene.find();
    CHECK(std::ranges::count_if(scene.found, across) >= 4);
    for (const Proximity& p : scene.found) CHECK(p.gap >= 0.0);
    // Pressed into each other they still know their sides.
    for (const int v : slit.upperLip) scene.surfaces[0].x[static_cast<std::size_t>(v)].z -= 0.5e-3;
    scene.find();
    CHECK(std::ranges::count_if(
              scene.found, [&](const Proximity& p) { return across(p) && std::fabs(p.gap + 0.3e-3) < 1e-6; }) >= 2);
}

TEST_CASE("a point before one face of a sharp edge of its own surface is not inside the other face")
{
    WedgeOverBox wedge;
    for (int step = 0; step < 3; ++step) { // the first tells the sides to the second
        wedge.scene.find();
        bool met = false;
        for (const Proximity& p : wedge.scene.found) {
            CHECK(p.gap > 0.0);
            met = met || ((p.vertices[0][0] == wedge.corner || p.vertices[1][0] == wedge.corner) &&
                          p.gap == Approx(WedgeOverBox::kGap));
        }
        CHECK(met);
    }
}

TEST_CASE("a body with narrow creases and thin spikes that stays as it is, is never inside itself")
{
    std::mt19937 random(23);
    int outside = 0, behind = 0;
    for (int round = 0; round < 40; ++round) {
        CAPTURE(round);
        Scene scene; // a star around its middle: no place of its surface is inside
        scene.add(lumpMesh(0.8, 24, 0.8, random), {.proximity = 0.05, .depth = 0.06, .self = true});
        for (int step = 0; step < 3; ++step) {
            scene.find();
            for (const Proximity& p : scene.found) {
                CHECK(p.gap >= 0.0);
                ++outside;
            }
        }
        for (const SheetSide& each : scene.sides) behind += each.side < 0 ? 1 : 0;
    }
    CHECK(outside > 1000);
    CHECK(behind > 100);
}

TEST_CASE("a body that moves as a whole comes no nearer to itself")
{
    std::mt19937 random(17);
    Scene scene;
    scene.dt = 0.02;
    scene.add(lumpMesh(0.8, 10, 0.1, random), {.proximity = 0.02, .depth = 0.03, .self = true});
    for (Vec3& x : scene.surfaces[0].x) { // bent over itself
        const double turn = 2.2 * x.x;
        x = Vec3{std::sin(turn) * (0.4 + x.z), x.y, std::cos(turn) * (0.4 + x.z)};
    }
    scene.find();
    const std::vector<std::array<int, 2>> atRest = scene.scratch.elementPairs;
    const std::vector<Proximity> found = scene.found;
    scene.surfaces[0].v.assign(scene.surfaces[0].v.size(),
                               Vec3{3.0, -40.0, 7.0}); // 1.2 m in the time of the look-ahead
    scene.find();
    CHECK(scene.scratch.elementPairs == atRest); // all pairs that face each other, before
    REQUIRE(scene.found.size() == found.size());
    for (std::size_t i = 0; i < found.size(); ++i) CHECK(scene.found[i].feature == found[i].feature);
    CHECK_FALSE(atRest.empty());
    CHECK_FALSE(found.empty());
}

TEST_CASE("a piece that has come off and flies away comes no nearer to itself, but to the other one")
{
    std::mt19937 random(17);
    geometry::TriangleMesh lumps = lumpMesh(0.8, 10, 0.1, random);
    const std::size_t half = lumps.vertices.size(), faces = lumps.triangles.size();
    for (std::size_t i = 0; i < half; ++i) lumps.vertices.push_back(lumps.vertices[i] + Vec3{0, 4, 0});
    for (std::size_t t = 0; t < faces; ++t) {
        geometry::Triangle each = lumps.triangles[t];
        for (int& vertex : each) vertex += static_cast<int>(half);
        lumps.triangles.push_back(each);
    }
    Scene scene;
    scene.dt = 0.02;
    scene.add(lumps, {.proximity = 0.02, .depth = 0.03, .self = true});
    CollisionSurface& surface = scene.surfaces[0];
    for (Vec3& x : surface.x) { // each bent over itself
        const double turn = 2.2 * x.x;
        x = Vec3{std::sin(turn) * (0.4 + x.z), x.y, std::cos(turn) * (0.4 + x.z)};
    }
    surface.pieceOf.assign(2 * half, 0);
    std::fill(surface.pieceOf.begin() + static_cast<std::ptrdiff_t>(half), surface.pieceOf.end(), 3);
    scene.find();
    const std::vector<std::array<int, 2>> atRest = scene.scratch.elementPairs;
    const std::size_t found = scene.found.size();
    CHECK_FALSE(atRest.empty());
    CHECK(found > 0);
    const auto fly = [&](Vec3 velocity) {
        std::fill(surface.v.begin() + static_cast<std::ptrdiff_t>(half), surface.v.end(), velocity);
        scene.find();
    };
    fly({3.0, 40.0, 7.0}); // away, by 1.2 m in the time of the look-ahead
    const auto within = [&](std::array<int, 2> pair) {
        const auto piece = [&](int e) { return surface.pieceOf[surface.shape->elements[e].vertices[0]]; };
        return piece(pair[0]) == piece(pair[1]);
    };
    CHECK(std::ranges::count_if(scene.scratch.elementPairs, within) == static_cast<std::ptrdiff_t>(atRest.size()));
    CHECK(scene.found.size() == found);
    fly({0, -80.0, 0}); // towards the other piece, 2.4 m away
    CHECK(scene.found.size() > found);
}

TEST_CASE("pairs of a surface's own elements that do not face each other have nothing to find")
{
    std::mt19937 random(17);
    std::size_t dropped = 0, kept = 0, lost = 0;
    for (int round = 0; round < 40; ++round) {
        Scene scene;
        addCrumpled({.proximity = 0.1, .depth = 0.2, .self = true}, 0.1, random, scene);
        scene.find();
        const CollisionSurface& surface = scene.surfaces[0];
        const SurfacePair meeting{{&surface, &surface}, {0, 0}, kStepsAhead * scene.dt};
        std::set<std::array<int, 2>> facing(scene.scratch.elementPairs.begin(), scene.scratch.elementPairs.end());
        collectElementPairs(surface, surface, nullptr, scene.scratch);
        for (const std::array<int, 2>& pair : scene.scratch.elementPairs) {
            if (facing.contains(pair)) {
                ++kept;
                continue;
            }
            ++dropped;
            lost += edgesThatMeet(meeting, pair).size();
            for (const PointMinimum& m : pointMinima(meeting, pair)) {
                CAPTURE(round, pair, m.point, m.proximity.gap);
                const auto& there = m.proximity.vertices[1];
                CHECK((m.proximity.gap < 0.0 || !m.facing || m.proximity.gap >= m.range || there[2] >= 0));
            }
        }
        REQUIRE(kept > 0);
    }
    CHECK(dropped > 10000);
    CHECK(lost == 0);
}

TEST_CASE("edges of a solid that meet are those that a test without its normals finds")
{
    std::mt19937 random(29);
    std::size_t met = 0;
    for (int round = 0; round < 20; ++round) {
        Scene scene;
        addCrumpled({.points = false, .proximity = 0.1, .depth = 0.2, .self = true}, 0.5, random, scene);
        scene.find();
        const CollisionSurface& surface = scene.surfaces[0];
        const SurfacePair meeting{{&surface, &surface}, {0, 0}, kStepsAhead * scene.dt};
        std::vector<Proximity> all;
        for (const std::array<int, 2>& pair : scene.scratch.elementPairs)
            for (const Proximity& each : edgesThatMeet(meeting, pair)) all.push_back(each);
        CHECK(featuresOf(scene.found) == featuresOf(all));
        met += all.size();
    }
    CHECK(met > 100);
}

TEST_CASE("a solid's proximity to itself may be smaller than the one to others, and finds what it would find alone")
{
    std::mt19937 random(31);
    std::size_t met = 0;
    for (int round = 0; round < 20; ++round) {
        std::mt19937 again = random;
        Scene both, alone;
        addCrumpled({.proximity = 0.2, .depth = 0.22, .self = true}, 0.5, random, both);
        addCrumpled({.proximity = 0.08, .depth = 0.1, .self = true}, 0.5, again, alone);
        CollisionShape shape = *both.surfaces[0].shape;
        shape.ownProximity = 0.08;
        both.surfaces[0].shape = std::make_shared<const CollisionShape>(shape);
        CHECK(shape.ownDepth() == Approx(0.1));
        both.add(boxMesh({0.02, 0.02, 0.02}), {.proximity = 0.1}, {.position = {0, 0, -1.0}}); // near it or not
        both.find();
        alone.find();
        std::erase_if(both.found, [](const Proximity& each) { return each.surfaces[0] != each.surfaces[1]; });
        CHECK(featuresOf(both.found) == featuresOf(alone.found));
        met += both.found.size();
    }
    CHECK(met > 200);
}

TEST_CASE("a solid looks for itself within a quarter of its mean edge, and for others within its proximity")
{
    for (const double cell : {0.4e-3, 8e-3}) {
        const auto mesh = geometry::shapes::block({4 * cell, 4 * cell, 4 * cell}, {4, 4, 4});
        physics::SoftBodyDef def{.name = "block"};
        def.collision = {{.self = true}};
        const std::vector<CollisionModel> models = buildCollision(def, *mesh);
        const CollisionModel& model = models.at(0);
        const double deepest = *std::ranges::max_element(model.inset.depth);
        CHECK(model.proximity == 0.5e-3);
        CHECK(model.shape->proximity == Approx(0.5e-3 + deepest));
        const double mean = (2.0 + std::sqrt(2.0)) / 3.0 * cell; // two edges along the axes to one across a square
        CHECK(model.ownProximity == Approx(std::min(0.5e-3, 0.25 * mean)));
        CHECK(model.shape->ownProximity == Approx(model.ownProximity + deepest));
    }
}

TEST_CASE("triangles of a sheet that an edge joins are tested where it is folded between them, and rolls everywhere")
{
    constexpr int kCells = 16;
    constexpr double kCell = 1.0 / kCells;
    const geometry::TriangleMesh sheet = sheetMesh(0.5, kCells);
    std::mt19937 random(5);
    std::size_t dropped = 0;
    double nearest = 1.0;                             // [edges]
    for (const double curl : {0.0, 3.0, 9.0, 16.0}) { // [rad] from end to end: from 7 on it is a roll, its layers apart
        Scene scene;
        scene.add(sheet, {.proximity = 0.03, .depth = 0.04, .self = true});
        for (Vec3& x : scene.surfaces[0].x) {
            const double turn = curl * (x.x + 0.5),
                         radius = curl > 0.0 ? 1.0 / curl + 0.02 * turn / (2.0 * std::numbers::pi) : 0.0;
            if (curl > 0.0) x = {radius * std::sin(turn), x.y, radius * std::cos(turn)};
            x += randomVector(random, 0.1 * kCell);
        }
        scene.find();
        const CollisionSurface& surface = scene.surfaces[0];
        const SurfacePair meeting{{&surface, &surface}, {0, 0}, kStepsAhead * scene.dt};
        std::set<std::array<int, 2>> tested(scene.scratch.elementPairs.begin(), scene.scratch.elementPairs.end());
        collectElementPairs(surface, surface, nullptr, scene.scratch);
        for (const std::array<int, 2>& pair : scene.scratch.elementPairs) {
            if (tested.contains(pair)) continue;
            ++dropped;
            for (const PointMinimum& each : pointMinima(meeting, pair))
                nearest = std::min(nearest, std::abs(each.proximity.gap) / kCell);
            const auto turned = [&](int of) {
                return curl * surface.shape->rest[surface.shape->elements[of].vertices[0]].x;
            };
            CHECK(std::abs(turned(pair[0]) - turned(pair[1])) < 0.5 * std::numbers::pi + 0.5); // never layers of a roll
        }
    }
    CHECK(dropped > 1000);
    CHECK(nearest > 0.4);
}

} // namespace filasofia::engine::self_collision_test
