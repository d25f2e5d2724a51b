#include "filasofia/surface/duct.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/math/pose.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace duct_test {
using namespace filasofia;
using namespace filasofia::surface;

constexpr double kPi = std::numbers::pi;

/// A straight vessel along x from 0 to 40 mm; its lumen has a radius of 1 mm.
struct Tube {
    std::shared_ptr<const geometry::TetMesh> mesh;
    std::vector<geometry::Triangle> skin;

    Tube()
    {
        std::vector<Vec3> line;
        for (int i = 0; i <= 40; ++i) line.push_back({1e-3 * i, 0, 0});
        mesh = geometry::shapes::vessel(line, 1e-3, 0.6e-3, {12, 1});
        skin = skinOf(*mesh);
    }
    /// Faces that belong to one tetrahedron only.
    static std::vector<geometry::Triangle> skinOf(const geometry::TetMesh& mesh)
    {
        std::map<std::array<int, 3>, std::pair<geometry::Triangle, int>> faces;
        for (const auto& [a, b, c, d] : mesh.tetrahedra)
            for (const geometry::Triangle& t : {geometry::Triangle{a, c, b}, {a, b, d}, {b, c, d}, {a, d, c}}) {
                std::array<int, 3> key = {t[0], t[1], t[2]};
                std::ranges::sort(key);
                auto& [face, count] = faces[key];
                face = t;
                ++count;
            }
        std::vector<geometry::Triangle> outside;
        for (const auto& [key, face] : faces)
            if (face.second == 1) outside.push_back(face.first);
        return outside;
    }
    [[nodiscard]] Duct duct(DuctDef def = {}) const
    {
        if (def.path.empty()) def.path = {{0, 0, 0}, {0.04, 0, 0}};
        return Duct(def, *mesh, skin, "duct");
    }
    /// The skin without the triangles that reach from one side of x [m] to the other: it has come apart there.
    [[nodiscard]] frame::Boundary cutAt(double x) const
    {
        frame::Boundary out{.revision = 1};
        for (const geometry::Triangle& t : skin) {
            int before = 0;
            for (int node : t) before += mesh->nodes[static_cast<std::size_t>(node)].x < x;
            if (before == 0 || before == 3) out.triangles.push_back(t);
        }
        return out;
    }
};

/// Squeezes the tube between two places along y, and lets it grow along z, so that its round lumen becomes an ellipse
/// with these half axes over its radius.
std::vector<Vec3> squeezed(const geometry::TetMesh& mesh, double from, double to, double a, double b)
{
    std::vector<Vec3> x = mesh.nodes;
    for (Vec3& each : x)
        if (each.x >= from && each.x <= to) each = {each.x, b * each.y, a * each.z};
    return x;
}

TEST_CASE("through a round tube flows what Poiseuille says")
{
    const Tube tube;
    Duct duct = tube.duct({.viscosity = 3.5e-3, .inletPressure = 3e3, .outletPressure = 1e3});
    duct.step({.positions = tube.mesh->nodes}, 1e-3);
    const double expected = kPi * std::pow(1e-3, 4) * 2e3 / (8.0 * 3.5e-3 * 0.04);
    CHECK(duct.balance().flow == Approx(expected).epsilon(0.01));
    CHECK(duct.balance().state == DuctState::Open);
    CHECK(duct.balance().narrowest == Approx(1.0).epsilon(0.01));
    CHECK(duct.balance().leak == 0.0);
}

TEST_CASE("through an elliptic tube flows what the closed form says, whichever way it lies")
{
    const Tube tube;
    for (const auto& [a, b] : {std::pair{1.3, 0.6}, std::pair{1.5, 0.3}, std::pair{0.5, 1.2}}) {
        Duct duct = tube.duct({.inletPressure = 1e3});
        std::vector<Vec3> x = squeezed(*tube.mesh, -1.0, 1.0, a, b);
        const Quat turned = axisAngle({0.3, 0.5, -0.8}, 1.1);
        for (Vec3& each : x) each = rotate(turned, each) + Vec3{0.1, 0.2, 0.3};
        duct.step({.positions = x}, 1e-3);
        const double p = std::pow(a * 1e-3, 3) * std::pow(b * 1e-3, 3) / (1e-6 * (a * a + b * b));
        CHECK(duct.balance().flow == Approx(kPi * 1e3 * p / (4.0 * 1e-3 * 0.04)).epsilon(0.02));
    }
}

TEST_CASE("resistances before and behind it, and a narrow part of it, add up")
{
    const Tube tube;
    const double whole = 8.0 * 1e-3 * 0.04 / (kPi * 1e-12);
    Duct duct = tube.duct({.inletPressure = 1e3, .inletResistance = 2.0 * whole, .outletResistance = whole});
    duct.step({.positions = tube.mesh->nodes}, 1e-3);
    CHECK(duct.balance().flow == Approx(1e3 / (4.0 * whole)).epsilon(0.01));
    // Eleven of its stations, of 1 mm each, have half the diameter: 16 times the resistance there.
    Duct narrow = tube.duct({.inletPressure = 1e3});
    narrow.step({.positions = squeezed(*tube.mesh, 0.0149, 0.0251, 0.5, 0.5)}, 1e-3);
    CHECK(narrow.balance().flow == Approx(1e3 / (whole * (29.0 + 11.0 * 16.0) / 40.0)).epsilon(0.01));
    CHECK(narrow.balance().narrowest == Approx(1.0 / 16.0).epsilon(0.01));
}

TEST_CASE("one narrow station resists as its place in a row of forty does")
{
    const Tube tube;
    const double whole = 8.0 * 1e-3 * 0.04 / (kPi * 1e-12);
    for (const double part : {0.5, 0.4}) {
        Duct duct = tube.duct({.inletPressure = 1e3});
        duct.step({.positions = squeezed(*tube.mesh, 0.0199, 0.0201, part, part)}, 1e-3);
        CHECK(duct.balance().flow == Approx(1e3 / (whole * (39.0 + std::pow(part, -4)) / 40.0)).epsilon(0.01));
    }
}

TEST_CASE("a path with a bend is open at rest")
{
    const Tube tube;
    for (const Vec3 end : {Vec3{0.02, 4e-3, 0}, Vec3{0.017, 3e-3, 0}}) {
        Duct duct = tube.duct({.path = {{0.005, 0, 0}, {0.02, 0, 0}, end}, .inletPressure = 1e3});
        duct.step({.positions = tube.mesh->nodes}, 1e-3);
        CHECK(duct.balance().narrowest == Approx(1.0).epsilon(1e-6));
    }
}

TEST_CASE("a tube that is cut at its very end leaks no more than a short open one")
{
    const Tube tube;
    const double spacing = 8.0 * 1e-3 * 1e-3 / (kPi * 1e-12); // [Pa s/m^3]
    for (const double x : {0.0005, 0.0395}) {
        const frame::Boundary cut = tube.cutAt(x);
        Duct duct = tube.duct({.inletPressure = 3e3, .outletPressure = 3e3});
        duct.step({.positions = tube.mesh->nodes, .boundary = &cut}, 1e-3);
        CHECK(duct.balance().state == DuctState::Leaking);
        CHECK(duct.balance().leak > 3e3 / spacing);
        CHECK(duct.balance().leak < 1.1 * 3e3 / spacing);
    }
}

TEST_CASE("a clip on a piece between two cuts keeps nothing back, and is counted nowhere")
{
    const Tube tube;
    frame::Boundary cut = tube.cutAt(0.0105);
    std::erase_if(cut.triangles, [&](const geometry::Triangle& t) {
        int before = 0;
        for (int node : t) before += tube.mesh->nodes[static_cast<std::size_t>(node)].x < 0.0305;
        return before != 0 && before != 3;
    });
    const std::array clips = {frame::Clip{.place = {0.005, 0, 0}}, frame::Clip{.place = {0.02, 0, 0}},
                              frame::Clip{.place = {0.035, 0, 0}}, frame::Clip{.place = {0.037, 0, 0}}};
    Duct duct = tube.duct({.inletPressure = 3e3});
    duct.step({.positions = tube.mesh->nodes, .boundary = &cut, .clips = clips}, 1e-3);
    CHECK(duct.balance().clipsBefore == 1);
    CHECK(duct.balance().clipsAfter == 2);
}

TEST_CASE("walls that were never one are no cut, and a restart forgets a cut")
{
    const Tube tube;
    frame::Boundary walls = tube.cutAt(-1.0); // nothing is cut, but the rims between its two walls are gone
    std::erase_if(walls.triangles, [&](const geometry::Triangle& t) {
        const auto at = [&](double x) {
            return std::ranges::all_of(
                t, [&](int node) { return std::abs(tube.mesh->nodes[static_cast<std::size_t>(node)].x - x) < 1e-6; });
        };
        return at(0.0) || at(0.04);
    });
    const DuctDef def{.path = {{0, 0, 0}, {0.04, 1.2e-3, 0}}, .radius = 1.2e-3, .inletPressure = 1e3};
    Duct duct(def, *tube.mesh, walls.triangles, "duct"); // it begins at the inner wall, and ends at the outer one
    duct.step({.positions = tube.mesh->nodes, .boundary = &walls}, 1e-3);
    CHECK(duct.balance().state == DuctState::Open);
    const frame::Boundary cut = tube.cutAt(0.0205);
    duct = tube.duct({.inletPressure = 1e3});
    duct.step({.positions = tube.mesh->nodes, .boundary = &cut}, 1e-3);
    CHECK(duct.balance().state == DuctState::Leaking);
    duct.restart();
    CHECK(duct.revision() == 0);
    CHECK(duct.ends().empty());
    frame::Boundary again{.revision = cut.revision, .triangles = tube.skin}; // as many edits, but others
    duct.step({.positions = tube.mesh->nodes, .boundary = &again}, 1e-3);
    CHECK(duct.balance().state == DuctState::Open);
}

TEST_CASE("a tube that is squeezed shut, or inside out, has no flow")
{
    const Tube tube;
    for (const double b : {0.02, 0.0, -0.1}) {
        Duct duct = tube.duct({.inletPressure = 1e3});
        const frame::Clip clip{.place = {0.02, 0, 0}};
        duct.step({.positions = squeezed(*tube.mesh, 0.019, 0.021, 1.4, b), .clips = {&clip, 1}}, 1e-3);
        CHECK(duct.balance().flow == 0.0);
        CHECK(duct.balance().state == DuctState::Clipped);
        CHECK(duct.balance().clipsBefore == 1);
    }
}

TEST_CASE("walls that pass through each other beside an open lumen do not shut it")
{
    // A clip that is too small presses the sides through each other and leaves the middle: the areas of the three lobes
    // cancel, but through the middle one flows what its size lets through.
    const Tube tube;
    Duct duct = tube.duct({.inletPressure = 1e3});
    const frame::Clip clip{.place = {0.02, 0, 0}};
    const auto step = [&](double middle, double sides) {
        std::vector<Vec3> x = tube.mesh->nodes;
        for (Vec3& each : x)
            if (std::abs(each.x - 0.02) <= 1e-3) each.y *= std::abs(each.z) < 0.6e-3 ? middle : sides;
        duct.step({.positions = x, .clips = {&clip, 1}}, 1e-3);
        return duct.balance();
    };
    CHECK(step(0.5, -0.9).narrowest > 0.02);
    CHECK(step(0.5, -0.9).state == DuctState::Open);
    CHECK(step(0.5, -0.9).flow > 0.0);
    CHECK(step(0.5, -0.9).narrowest < step(0.5, 0.0).narrowest * 1.5);
    CHECK(step(-0.5, -0.9).state == DuctState::Clipped);
    CHECK(step(-0.5, -0.9).flow == 0.0);
}

TEST_CASE("a tube that something else squeezes shut is not clipped")
{
    const Tube tube;
    Duct duct = tube.duct({.inletPressure = 1e3});
    const frame::Clip clip{.place = {0.03, 0, 0}}; // on it, but open
    for (const std::size_t clips : {0, 1}) {
        duct.step({.positions = squeezed(*tube.mesh, 0.009, 0.011, 1.4, 0.02), .clips = {&clip, clips}}, 1e-3);
        CHECK(duct.balance().state == DuctState::Squeezed);
        CHECK(isWhole(duct.balance().state));
        CHECK(duct.balance().flow == 0.0);
    }
}

TEST_CASE("a clip before the inlet or behind the outlet is on another tube")
{
    const Tube tube;
    Duct duct = tube.duct({.path = {{0.01, 0, 0}, {0.03, 0, 0}}, .inletPressure = 1e3});
    const auto count = [&](double x) {
        const frame::Clip clip{.place = {x, 0, 0}};
        duct.step({.positions = tube.mesh->nodes, .clips = {&clip, 1}}, 1e-3);
        return duct.balance().clipsBefore;
    };
    CHECK(count(0.008) == 0);
    CHECK(count(0.0098) == 1);
    CHECK(count(0.02) == 1);
    CHECK(count(0.0302) == 1);
    CHECK(count(0.032) == 0);
}

TEST_CASE("a cut tube leaks by Poiseuille from both ends, and not from one that is shut")
{
    const Tube tube;
    const double whole = 8.0 * 1e-3 * 0.04 / (kPi * 1e-12);
    const frame::Boundary cut = tube.cutAt(0.0205);
    const DuctDef def{.inletPressure = 3e3, .outletPressure = 1e3};
    Duct duct = tube.duct(def);
    for (int i = 0; i < 100; ++i) duct.step({.positions = tube.mesh->nodes, .boundary = &cut}, 1e-3);
    CHECK(duct.balance().state == DuctState::Leaking);
    CHECK(duct.balance().leak == Approx(8e3 / whole).epsilon(0.1)); // half of its length on each side
    CHECK(duct.balance().lost == Approx(0.1 * duct.balance().leak).epsilon(1e-9));
    CHECK(duct.balance().flow == 0.0);
    REQUIRE(duct.ends().size() == 2);
    CHECK(duct.ends()[0].place.x == Approx(0.02).margin(1.5e-3));
    CHECK(duct.ends()[1].leak > 0.0);

    const std::array clips = {frame::Clip{.place = {0.008, 0, 0}}, frame::Clip{.place = {0.012, 0, 0}},
                              frame::Clip{.place = {0.03, 0, 0}}, frame::Clip{.place = {0.0, 0.05, 0}}};
    Duct shut = tube.duct(def);
    const std::vector<Vec3> before = squeezed(*tube.mesh, 0.007, 0.013, 1.4, 0.0);
    shut.step({.positions = before, .boundary = &cut, .clips = clips}, 1e-3);
    CHECK(shut.balance().state == DuctState::Leaking); // from the outlet's side
    CHECK(shut.ends()[0].leak == 0.0);
    CHECK(shut.ends()[1].leak > 0.0);
    CHECK(shut.balance().clipsBefore == 2);
    CHECK(shut.balance().clipsAfter == 1); // the last one is far away
    std::vector<Vec3> both = before;
    for (Vec3& each : both)
        if (each.x >= 0.0295 && each.x <= 0.0305) each.y = 0.0;
    shut.step({.positions = both, .boundary = &cut, .clips = clips}, 1e-3);
    CHECK(shut.balance().state == DuctState::Cut);
    CHECK(shut.balance().leak == 0.0);
}

TEST_CASE("a path that is no path is an Error")
{
    const Tube tube;
    const auto problem = [&](const std::vector<Vec3>& path, double radius = 1e-3) -> std::string {
        try {
            static_cast<void>(Duct({.path = path, .radius = radius}, *tube.mesh, tube.skin, "duct 'd'"));
        } catch (const Error& error) {
            return error.what();
        }
        return "none";
    };
    CHECK(problem({}) == "duct 'd': path must have at least two points, got 0");
    CHECK(problem({{0, 0, 0}}) == "duct 'd': path must have at least two points, got 1");
    CHECK(problem({{0, 0, 0}, {0, 0, 0}}) == "duct 'd': path[0] and path[1] must be two places, got one");
    CHECK(problem({{0, 0, 0}, {0.1, 0, 0}}).starts_with("duct 'd': path must run through the body, but is "));
    CHECK(problem({{0, 0, 0}, {1e300, 0, 0}}).starts_with("duct 'd': path must be at most 100 m long, got "));
    CHECK(problem({{0, 0, 0}, {0.02, 0, 0}, {0, 0, 0}}) == "duct 'd': path must not turn back, but does at path[1]");
    std::vector<Vec3> zigzag; // each of its edges is shorter than the way between two stations
    for (int i = 0; i < 200; ++i) zigzag.push_back({1e-4 * i, i % 2 == 0 ? 0.0 : 3e-4, 0});
    CHECK(problem(zigzag) == "duct 'd': path must not turn back, but does at path[1]");
    CHECK(problem({{0, 0, 0}, {0.04, 0, 0}}) == "none");
    CHECK(problem({{0, 0, 0}, {0.04, 0, 0}}, 0.02).starts_with("duct 'd': radius must be that of a tube through"));
    CHECK(
        problem({{0, 0, 0}, {0.04, 0, 0}}, 0.05).starts_with("duct 'd': path must be at least as long as its radius"));
}

TEST_CASE(
    "a radius that is not that of the space inside is an Error, and one between the half widths of a flat lumen is not")
{
    Tube tube;
    const auto problem = [&](double radius) -> std::string {
        try {
            static_cast<void>(tube.duct({.radius = radius}));
        } catch (const Error& error) {
            return error.what();
        }
        return "none";
    };
    CHECK(problem(1.15e-3) == "none");
    CHECK(problem(0.85e-3) == "none");
    for (const double wrong : {0.5e-3, 1.4e-3, 2.5e-3}) { // inside, in the wall, beyond it
        INFO(problem(wrong));
        CHECK(problem(wrong).starts_with("duct: radius must be that of a tube through the body, whose wall is "));
        CHECK(problem(wrong).ends_with(text(" where it fits best, got ", wrong, " m")));
    }
    const auto round = tube.mesh;
    const auto reshaped = [&](auto&& place) {
        geometry::TetMesh mesh = *round;
        for (Vec3& each : mesh.nodes) each = place(each);
        tube.mesh = std::make_shared<const geometry::TetMesh>(mesh);
    };
    reshaped([](Vec3 p) { return Vec3{p.x, 0.4 * p.y, 1.6 * p.z}; });
    for (const double fits : {0.4e-3, 0.56e-3, 1e-3, 1.6e-3}) CHECK(problem(fits) == "none");
    for (const double wrong : {0.25e-3, 2.2e-3}) CHECK(problem(wrong) != "none");
    reshaped([](Vec3 p) { // it is wide at one end
        const double wide = 1.0 + p.x / 0.04;
        return Vec3{p.x, wide * p.y, wide * p.z};
    });
    for (const double fits : {1e-3, 1.5e-3, 2e-3}) CHECK(problem(fits) == "none");
    for (const double wrong : {0.6e-3, 3e-3}) CHECK(problem(wrong) != "none");
}

TEST_CASE("in solid tissue a duct has any radius up to the skin")
{
    const auto mesh = geometry::shapes::block({0.04, 0.01, 0.01}, {8, 4, 4});
    const std::vector<geometry::Triangle> skin = Tube::skinOf(*mesh);
    const auto problem = [&](double radius) -> std::string {
        try {
            static_cast<void>(Duct({.path = {{-0.02, 0, 0}, {0.02, 0, 0}}, .radius = radius}, *mesh, skin, "duct"));
        } catch (const Error& error) {
            return error.what();
        }
        return "none";
    };
    for (const double fits : {1e-3, 3e-3, 5e-3}) CHECK(problem(fits) == "none");
    CHECK(problem(9e-3).starts_with("duct: radius must be that of a tube through the body"));
}

} // namespace duct_test
