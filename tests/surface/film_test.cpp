#include "filasofia/surface/film.h"

#include "filasofia/geometry/shapes.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numeric>
#include <random>

namespace film_test {
using namespace filasofia;
using namespace filasofia::surface;

constexpr FilmLiquid kOil{
    .viscosity = 0.05, .hardening = 1e9, .density = 900.0, .surfaceTension = 0.03, .clinging = 0.0};
constexpr double kG = 9.81;

/// A sheet that is steep by `angle` along x: gravity is turned in its place.
struct Incline {
    FilmTopology topology;
    std::vector<Vec3> places;
    FilmGeometry geometry;
    FilmContent content;
    std::vector<int> order;

    Incline(double length, double width, std::array<int, 2> cells, double angle)
    {
        const auto sheet = geometry::shapes::sheet(length, width, cells);
        places = sheet->vertices;
        const Vec3 normal = normalized(cross(places[sheet->triangles[0][1]] - places[sheet->triangles[0][0]],
                                             places[sheet->triangles[0][2]] - places[sheet->triangles[0][0]]));
        topology = filmTopology(static_cast<int>(places.size()), sheet->triangles);
        measure(topology, places, kG * (std::sin(angle) * Vec3{1, 0, 0} - std::cos(angle) * normal), geometry);
        content.volume.assign(places.size(), 0.0);
        content.aged = content.volume;
    }
    double flowFor(double dt) { return flow(topology, geometry, kOil, dt, content, order); }
    double volume() const { return std::accumulate(content.volume.begin(), content.volume.end(), 0.0); }
};

TEST_CASE("a steady film on an incline has Nusselt's thickness and velocity, whatever the step")
{
    const double angle = GENERATE(0.3, 0.8, 1.4), dt = GENERATE(1.0 / 60.0, 1.0 / 500.0);
    const double width = 0.02, perWidth = 5e-6; // [m^2/s]
    Incline film(0.06, width, {30, 10}, angle);
    double fed = 0.0, dripped = 0.0, last = 0.0;
    for (double t = 0.0; t < 25.0; t += dt) {
        double top = 0.0; // the upper rim is fed
        for (std::size_t v = 0; v < film.places.size(); ++v)
            if (film.places[v].x < -0.0299) top += film.geometry.area[v];
        for (std::size_t v = 0; v < film.places.size(); ++v)
            if (film.places[v].x < -0.0299)
                film.content.volume[v] += perWidth * width * dt * film.geometry.area[v] / top;
        fed += perWidth * width * dt;
        last = film.flowFor(dt);
        dripped += last;
    }
    CHECK(last / dt == Approx(perWidth * width).epsilon(1e-3)); // steady: what comes goes
    CHECK(film.volume() + dripped == Approx(fed).epsilon(1e-9));
    const double nusselt = std::cbrt(3.0 * kOil.viscosity * perWidth / (kOil.density * kG * std::sin(angle)));
    double sum = 0.0, area = 0.0;
    for (std::size_t v = 0; v < film.places.size(); ++v)
        if (std::abs(film.places[v].x) < 0.02) sum += film.content.volume[v], area += film.geometry.area[v];
    const double thickness = sum / area, velocity = perWidth / thickness;
    INFO("thickness " << thickness << " m, Nusselt " << nusselt);
    CHECK(thickness == Approx(nusselt).epsilon(0.01));
    CHECK(velocity ==
          Approx(kOil.density * kG * nusselt * nusselt * std::sin(angle) / (3.0 * kOil.viscosity)).epsilon(0.01));
}

TEST_CASE("the front of a film that runs down an incline moves at the speed of its kinematic wave")
{
    // Behind the front of a film that is fed steadily the thickness is Nusselt's, so the front moves at the mean
    // velocity.
    const double width = 0.01, perWidth = 5e-6, dt = 1.0 / 240.0, angle = 0.8;
    Incline film(0.12, width, {120, 10}, angle);
    const auto front = [&] {
        double x = -0.06;
        for (std::size_t v = 0; v < film.places.size(); ++v)
            if (film.content.volume[v] / film.geometry.area[v] > 2e-4) x = std::max(x, film.places[v].x);
        return x;
    };
    double at = 0.0;
    for (int i = 0; i < 2160; ++i) {
        for (std::size_t v = 0; v < film.places.size(); ++v)
            if (film.places[v].x < -0.0599) film.content.volume[v] += perWidth * width * dt / 11.0;
        film.flowFor(dt);
        if (i == 239) at = front();
    }
    const double nusselt = std::cbrt(3.0 * kOil.viscosity * perWidth / (kOil.density * kG * std::sin(angle)));
    CHECK(front() - at == Approx(8.0 * perWidth / nusselt).epsilon(0.03));
}

TEST_CASE("a pool in a hollow becomes level and stays there")
{
    auto sheet = *geometry::shapes::sheet(0.04, 0.04, {20, 20});
    for (Vec3& p : sheet.vertices) p.y = 8.0 * (p.x * p.x + p.z * p.z); // a bowl, 6 mm deep at the corners
    const FilmTopology topology = filmTopology(static_cast<int>(sheet.vertices.size()), sheet.triangles);
    FilmGeometry bowl;
    measure(topology, sheet.vertices, {0, -kG, 0}, bowl);
    FilmContent content;
    content.volume.assign(sheet.vertices.size(), 0.0);
    content.aged = content.volume;
    for (std::size_t v = 0; v < content.volume.size(); ++v)
        if (std::abs(sheet.vertices[v].x - 0.006) < 0.004) content.volume[v] = 1e-3 * bowl.area[v];
    const double all = std::accumulate(content.volume.begin(), content.volume.end(), 0.0);
    std::vector<int> order;
    double dripped = 0.0;
    for (int i = 0; i < 1200; ++i) dripped += flow(topology, bowl, kOil, 1.0 / 60.0, content, order);
    double low = 1.0, high = -1.0, sum = 0.0;
    for (std::size_t v = 0; v < content.volume.size(); ++v) {
        sum += content.volume[v];
        const double thickness = content.volume[v] / bowl.area[v];
        if (thickness < 3e-4) continue; // the thin film above the pool still runs down
        low = std::min(low, bowl.elevation[v] + thickness * bowl.upward[v]);
        high = std::max(high, bowl.elevation[v] + thickness * bowl.upward[v]);
    }
    INFO("level between " << low << " and " << high);
    CHECK(high > 5e-4);
    CHECK(high - low < 1e-4);
    CHECK(sum + dripped == Approx(all).epsilon(1e-12));
}

TEST_CASE("volume is conserved and stays positive on any surface, with any step")
{
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    auto ball = *geometry::shapes::sphere(0.02, 10);
    for (int trial = 0; trial < 20; ++trial) {
        auto mesh = ball;
        for (Vec3& p : mesh.vertices) p += 0.002 * unit(random) * Vec3{unit(random), unit(random), unit(random)};
        const FilmTopology topology = filmTopology(static_cast<int>(mesh.vertices.size()), mesh.triangles);
        FilmGeometry geometry;
        measure(topology, mesh.vertices, {3.0 * unit(random), -kG, 0}, geometry);
        FilmContent content;
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v) content.volume.push_back(1e-8 * unit(random));
        content.aged = content.volume;
        const double all = std::accumulate(content.volume.begin(), content.volume.end(), 0.0);
        std::vector<int> order;
        double dripped = 0.0;
        const double dt = std::pow(10.0, -4.0 + 5.0 * unit(random));
        for (int i = 0; i < 50; ++i) dripped += flow(topology, geometry, kOil, dt, content, order);
        CHECK(*std::ranges::min_element(content.volume) >= 0.0);
        CHECK(std::accumulate(content.volume.begin(), content.volume.end(), 0.0) + dripped ==
              Approx(all).epsilon(1e-12));
        CHECK(dripped > 0.0);
    }
}

TEST_CASE("a film below a ceiling drips as the Rayleigh-Taylor instability grows")
{
    Incline film(0.02, 0.02, {10, 10}, 0.0);
    for (double& each : film.geometry.upward) each = -1.0; // turned over
    for (double& each : film.geometry.rim) each = 0.0;
    for (double& each : film.geometry.conductance) each = 0.0;
    const double start = 5e-4, weight = kOil.density * kG, time = 0.5;
    for (std::size_t v = 0; v < film.places.size(); ++v) film.content.volume[v] = start * film.geometry.area[v];
    for (int i = 0; i < 30; ++i) film.flowFor(time / 30.0);
    const double growth = weight * weight / (12.0 * kOil.viscosity * kOil.surfaceTension);
    const double expected = start / std::cbrt(1.0 + 3.0 * growth * time * start * start * start);
    CHECK(film.content.volume[60] / film.geometry.area[60] == Approx(expected).epsilon(1e-9));
}

TEST_CASE("drops land on what is below them")
{
    // A small ceiling, which faces down, 1 cm above a floor; beside it, one above nothing.
    geometry::TriangleMesh mesh = *geometry::shapes::sheet(0.04, 0.04, {8, 8});
    const auto ceiling = [&mesh](Vec3 corner) {
        const int first = static_cast<int>(mesh.vertices.size());
        for (const Vec3 p : {Vec3{}, Vec3{0.004, 0, 0}, Vec3{0, 0, 0.004}}) mesh.vertices.push_back(corner + p);
        mesh.triangles.push_back({first, first + 1, first + 2});
        return first;
    };
    const int over = ceiling({0.0, 0.01, 0.0}), beside = ceiling({0.1, 0.01, 0.0});
    const FilmTopology topology = filmTopology(static_cast<int>(mesh.vertices.size()), mesh.triangles);
    FilmGeometry geometry;
    measure(topology, mesh.vertices, {0, -kG, 0}, geometry);
    REQUIRE(geometry.upward[over] == -1.0);
    FilmContent content;
    content.volume.assign(mesh.vertices.size(), 0.0);
    content.volume[over] = content.volume[beside] = 1e-8;
    content.aged = content.volume;
    findLandings(topology, mesh.vertices, {0, -kG, 0}, content, geometry);
    CHECK(distance(mesh.vertices[geometry.landing[over]], {0, 0, 0}) < 0.005);
    CHECK(geometry.landing[beside] == -1);
    CHECK(geometry.landing[over + 1] == FilmGeometry::kUnknown); // it is dry
    std::vector<int> order;
    const double gone = flow(topology, geometry, kOil, 0.1, content, order);
    CHECK(gone == Approx(1e-8 - content.volume[beside]));
    CHECK(content.volume[beside] < 0.5e-8);
    CHECK(std::accumulate(content.volume.begin(), content.volume.end(), 0.0) + gone == Approx(2e-8));
}

TEST_CASE("the implicit thickness solves its equation")
{
    for (const double b : {1e-9, 1e-4, 1e-2, 1.0})
        for (const double c : {0.0, 1e-6, 1.0, 1e6, 1e12}) {
            const double x = implicitThickness(b, c);
            CHECK(x >= 0.0);
            CHECK(x <= b);
            CHECK(x + c * x * x * x == Approx(b).epsilon(1e-10));
        }
    CHECK(implicitThickness(0.0, 1.0) == 0.0);
}
} // namespace film_test
