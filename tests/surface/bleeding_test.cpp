#include "filasofia/surface/bleeding.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/shapes.h"

#include <catch2/catch.hpp>

#include <cmath>

namespace bleeding_test {
using namespace filasofia;
using namespace filasofia::surface;

constexpr double kEven = std::numeric_limits<double>::infinity();
constexpr Vec3 kDown{0, -9.81, 0};

double error(const BloodBalance& b)
{
    return std::abs(b.welled - b.onTissue - b.sucked - b.rinsed - b.dripped - b.carriedOff);
}

struct Ball {
    std::shared_ptr<const geometry::TriangleMesh> mesh = geometry::shapes::sphere(0.03, 12);
    Bleeding blood;
    explicit Ball(BleedingDef def = {}) : blood(def, mesh->triangles, "ball") {}
    void run(double seconds)
    {
        for (int i = 0; i < std::lround(seconds * 60.0); ++i) blood.step(mesh->vertices, kDown, 1.0 / 60.0);
    }
    /// As a cut opens the triangles above this height.
    [[nodiscard]] frame::Boundary opened(double above, std::uint64_t revision) const
    {
        frame::Boundary out{.revision = revision, .triangles = mesh->triangles, .rest = mesh->vertices};
        for (const auto& [a, b, c] : mesh->triangles)
            out.opened.push_back(mesh->vertices[a].y > above && mesh->vertices[b].y > above &&
                                 mesh->vertices[c].y > above);
        return out;
    }
};

TEST_CASE("nothing bleeds before a cut, and a step then costs nothing")
{
    Ball ball;
    ball.run(1.0);
    CHECK(ball.blood.balance() == BloodBalance{});
}

TEST_CASE("an opened surface bleeds by its area and flux, less as it clots")
{
    Ball ball({.flux = 1e-4, .vesselDensity = kEven, .clottingTime = 10.0});
    ball.blood.follow(ball.opened(0.02, 1));
    double area = 0.0;
    const frame::Boundary boundary = ball.opened(0.02, 1);
    for (std::size_t t = 0; t < boundary.triangles.size(); ++t) {
        const auto& [a, b, c] = boundary.triangles[t];
        const auto& p = ball.mesh->vertices;
        if (boundary.opened[t]) area += 0.5 * length(cross(p[b] - p[a], p[c] - p[a]));
    }
    ball.run(5.0);
    CHECK(ball.blood.balance().welled == Approx(1e-4 * area * 10.0 * (1.0 - std::exp(-0.5))).epsilon(1e-9));
    CHECK(ball.blood.balance().rate == Approx(1e-4 * area * std::exp(-0.5)).epsilon(1e-9));
    ball.run(60.0);
    CHECK(ball.blood.balance().rate < 0.01e-4 * area);
    CHECK(error(ball.blood.balance()) < 1e-12 * ball.blood.balance().welled);
}

TEST_CASE("few vessels bleed unevenly, and on average as many")
{
    const auto welled = [](double density) {
        Ball ball({.flux = 1e-4, .vesselDensity = density});
        ball.blood.follow(ball.opened(-0.03, 1));
        ball.run(0.1);
        std::vector<float> thickness = ball.blood.thickness();
        return std::pair(ball.blood.balance().welled, std::ranges::count(thickness, 0.0F));
    };
    const auto [even, dryEven] = welled(kEven);
    const auto [few, dryFew] = welled(2e5);
    CHECK(few == Approx(even).epsilon(0.15)); // about 2000 vessels
    CHECK(dryFew > dryEven);
}

TEST_CASE("welled blood is on the tissue, sucked, rinsed, dripped or carried off, to the last millionth")
{
    Ball ball({.flux = 5e-4, .clottingTime = 20.0});
    ball.blood.apply(Injure{{0, 0.03, 0}, 0.01}, ball.mesh->vertices);
    ball.run(3.0);
    ball.blood.apply(Suck{{0.01, 0.028, 0}, 0.008, 2e-8}, ball.mesh->vertices);
    ball.run(3.0);
    ball.blood.apply(Rinse{{-0.01, 0.02, 0}, 0.01}, ball.mesh->vertices);
    ball.run(3.0);
    // The northern cap leaves as a piece.
    frame::Boundary rest{.revision = 1, .rest = ball.mesh->vertices};
    for (const auto& each : ball.mesh->triangles)
        if (ball.mesh->vertices[each[0]].y < 0.02) rest.triangles.push_back(each);
    rest.opened.assign(rest.triangles.size(), 0);
    ball.blood.follow(rest);
    ball.run(3.0);
    const BloodBalance b = ball.blood.balance();
    CHECK(b.sucked > 1e-9);
    CHECK(b.rinsed > 1e-9);
    CHECK(b.dripped > 1e-10);
    CHECK(b.carriedOff > 1e-9);
    CHECK(error(b) < 1e-9 * b.welled);
}

TEST_CASE("what is poured on is welled, at its rate, near the place or at the nearest point")
{
    Ball ball({.flux = 1e-4});
    ball.run(0.1);
    for (int i = 0; i < 20; ++i) {
        ball.blood.apply(Pour{{0, i % 2 == 0 ? 0.03 : 0.2, 0}, 0.005, 1e-9}, ball.mesh->vertices);
        ball.run(0.05);
    }
    CHECK(ball.blood.balance().rate == Approx(2e-8).epsilon(0.5));
    ball.run(0.5);
    const BloodBalance b = ball.blood.balance();
    CHECK(b.welled == Approx(20e-9).epsilon(1e-12));
    CHECK(b.rate == 0.0);
    CHECK(error(b) < 1e-12 * b.welled);
    ball.blood.apply(Pour{{0, 0.03, 0}, 0.005, 1e-9}, ball.mesh->vertices);
    ball.blood.step(ball.mesh->vertices, {0, -9.81, 0}, 0.01);
    CHECK(ball.blood.balance().rate == Approx(1e-8));
    ball.run(0.5);
    CHECK(ball.blood.balance().rate == 0.0);
}

TEST_CASE("pausing and sealing stop a wound, and only sealing is for good")
{
    Ball ball({.flux = 1e-4});
    ball.blood.apply(Injure{{0, 0.03, 0}, 0.01}, ball.mesh->vertices);
    ball.run(0.5);
    ball.blood.apply(Perfuse{0.0}, ball.mesh->vertices);
    const double before = ball.blood.balance().welled;
    ball.run(0.5);
    CHECK(ball.blood.balance().welled == before);
    ball.blood.apply(Perfuse{1.0}, ball.mesh->vertices);
    ball.run(0.5);
    CHECK(ball.blood.balance().welled > before);
    ball.blood.apply(Seal{{0, 0.03, 0}, 0.011}, ball.mesh->vertices);
    const double sealed = ball.blood.balance().welled;
    ball.run(0.5);
    CHECK(ball.blood.balance().welled == sealed);
    CHECK(ball.blood.balance().rate == 0.0);
}

TEST_CASE("a body that is put back to its start is whole and clean again")
{
    Ball ball;
    ball.blood.follow(ball.opened(0.02, 3));
    ball.run(1.0);
    CHECK(ball.blood.balance().onTissue > 0.0);
    ball.blood.follow({.revision = 0, .triangles = ball.mesh->triangles});
    ball.run(1.0);
    CHECK(ball.blood.balance() == BloodBalance{});
}

TEST_CASE("new nodes of a split surface take their blood from those around them")
{
    Ball ball({.flux = 5e-4});
    ball.blood.apply(Injure{{0, 0.03, 0}, 0.012}, ball.mesh->vertices);
    ball.run(2.0);
    const BloodBalance before = ball.blood.balance();
    // Every triangle gets a node in its middle.
    frame::Boundary fine{.revision = 1, .rest = ball.mesh->vertices};
    std::vector<Vec3> places = ball.mesh->vertices;
    for (const auto& [a, b, c] : ball.mesh->triangles) {
        const int middle = static_cast<int>(places.size());
        places.push_back((places[a] + places[b] + places[c]) / 3.0);
        for (const auto& each : {geometry::Triangle{a, b, middle}, {b, c, middle}, {c, a, middle}})
            fine.triangles.push_back(each);
    }
    fine.opened.assign(fine.triangles.size(), 0);
    ball.blood.follow(fine);
    CHECK(ball.blood.balance().onTissue == Approx(before.onTissue).epsilon(1e-12));
    ball.blood.step(places, kDown, 1.0 / 60.0);
    const std::vector<float> thickness = ball.blood.thickness();
    CHECK(thickness.size() == places.size());
    CHECK(*std::max_element(thickness.begin() + static_cast<long>(ball.mesh->vertices.size()), thickness.end()) > 1e-5);
}

TEST_CASE("a wrong field is one clear error")
{
    CHECK_THROWS_WITH(Ball({.flux = -1.0}), Catch::Contains("ball: flux must be >= 0 m/s, got -1"));
    CHECK_THROWS_WITH(Bleeding({}, {}, "liver"), Catch::Contains("liver: needs a surface"));
}
} // namespace bleeding_test
