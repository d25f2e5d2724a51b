#include "filasofia/surface/burning.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/surface/heat.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

namespace burning_test {
using namespace filasofia;
using namespace filasofia::surface;
using std::numbers::pi;

constexpr double kEverywhere = std::numeric_limits<double>::infinity();
constexpr double kStep = 1.0 / 60.0;

double error(const HeatBalance& b) { return b.delivered - b.stored - b.perfused - b.lost - b.boiled - b.carriedOff; }

/// A flat square.
struct Plate {
    std::shared_ptr<const geometry::TriangleMesh> mesh;
    Burning heat;
    Plate(BurningDef def, double edge, double side = 0.04)
        : mesh(geometry::shapes::sheet(side, side, {cells(side, edge), cells(side, edge)})),
          heat(def, mesh->triangles, "plate")
    {
    }
    static int cells(double side, double edge) { return static_cast<int>(std::lround(side / edge)); }
    void run(double seconds, double dt = kStep)
    {
        for (int i = 0; i < std::lround(seconds / dt); ++i) heat.step(mesh->vertices, {}, dt);
    }
    /// [K] above rest, at the vertex nearest to a place, and how far it is from the middle.
    [[nodiscard]] std::pair<double, double> near(Vec3 place) const
    {
        std::size_t best = 0;
        for (std::size_t v = 0; v < mesh->vertices.size(); ++v)
            if (distance(mesh->vertices[v], place) < distance(mesh->vertices[best], place)) best = v;
        return {heat.temperature(best) - heat.def().temperature, length(mesh->vertices[best])};
    }
    [[nodiscard]] double area() const
    {
        double sum = 0.0;
        for (const auto& [a, b, c] : mesh->triangles)
            sum += 0.5 * length(cross(mesh->vertices[b] - mesh->vertices[a], mesh->vertices[c] - mesh->vertices[a]));
        return sum;
    }
};

/// Nothing but conduction, and no damage.
BurningDef conducting() { return {.perfusion = 0.0, .loss = 0.0, .water = 0.0, .frequencyFactor = 0.0}; }

/// A round source of uniform flux in an infinite sheet, [K] at the distance r after t seconds: the heat that it gave
/// spreads as a Gaussian does (Carslaw and Jaeger 1959, 10.3), integrated over the disc and the time.
double fromDisc(const BurningDef& def, double power, double radius, double r, double t)
{
    const double diffusivity = def.conductivity / (def.density * def.heatCapacity);
    double sum = 0.0;
    constexpr int kTimes = 400, kRings = 24, kAngles = 24;
    for (int i = 0; i < kTimes; ++i) {
        const double u = (i + 0.5) / kTimes, age = t * u * u, dAge = 2.0 * t * u / kTimes; // finer where it is young
        for (int j = 0; j < kRings; ++j)
            for (int k = 0; k < kAngles; ++k) {
                const double s = radius * std::sqrt((j + 0.5) / kRings), angle = 2.0 * pi * (k + 0.5) / kAngles;
                const double square = r * r + s * s - 2.0 * r * s * std::cos(angle);
                sum += dAge * std::exp(-square / (4.0 * diffusivity * age)) / age;
            }
    }
    return power * sum / (kRings * kAngles) / (4.0 * pi * def.conductivity * def.depth);
}

TEST_CASE("heat spreads from a disc as theory says, whatever the size of the triangles")
{
    const BurningDef def = conducting();
    constexpr double kPower = 0.2, kRadius = 3e-3, kTime = 20.0;
    for (const double edge : {0.5e-3, 1e-3, 2e-3}) {
        Plate plate(def, edge);
        plate.heat.apply({.radius = kRadius, .power = kPower, .limit = 1000.0}, {});
        plate.run(kTime);
        const double bound = edge < 2e-3 ? 0.03 : 0.08; // triangles that are too coarse for the source
        for (const double x : {0.0, 2e-3, 4e-3}) {
            const auto [warmth, r] = plate.near({x, 0, 0});
            INFO("edge " << edge << ", r " << r);
            CHECK(warmth == Approx(fromDisc(def, kPower, kRadius, r, kTime)).epsilon(bound));
        }
        const auto [far, r] = plate.near({6e-3, 0, 0});
        CHECK(far == Approx(fromDisc(def, kPower, kRadius, r, kTime)).margin(0.015 * plate.near({}).first));
        CHECK(plate.heat.balance().delivered == Approx(kPower * kTime).epsilon(1e-9));
        CHECK(std::abs(error(plate.heat.balance())) < 1e-9 * kPower * kTime);
    }
}

TEST_CASE("a drop of heat becomes a Gaussian")
{
    const BurningDef def = conducting();
    Plate plate(def, 0.5e-3);
    plate.heat.apply({.radius = 0.4e-3, .power = 2.0, .limit = 1e6}, {});
    plate.run(0.1, 0.01); // 0.2 J
    plate.heat.apply({.power = 0.0}, {});
    plate.run(15.0);
    const double diffusivity = def.conductivity / (def.density * def.heatCapacity);
    for (const double x : {0.0, 1e-3, 2e-3, 3e-3}) {
        const auto [warmth, r] = plate.near({x, 0, 0});
        const double gaussian =
            0.2 / (4.0 * pi * def.conductivity * def.depth * 15.05) * std::exp(-r * r / (4.0 * diffusivity * 15.05));
        CHECK(warmth == Approx(gaussian).epsilon(0.05));
    }
}

TEST_CASE("in the end perfusion and loss carry away the power, and warmth falls with the distance as K0 does")
{
    BurningDef def = conducting();
    def.perfusion = 0.03;
    def.loss = 200.0;
    def.density = 100.0; // it is steady sooner
    Plate plate(def, 0.5e-3, 0.03);
    plate.heat.apply({.radius = 1e-3, .power = 0.1, .limit = 1000.0}, {});
    plate.run(40.0);
    const HeatBalance before = plate.heat.balance();
    plate.run(1.0);
    const HeatBalance now = plate.heat.balance();
    const double sink = def.perfusion * def.bloodHeatCapacity * def.depth;
    CHECK(now.perfused - before.perfused == Approx(0.1 * sink / (sink + def.loss)).epsilon(1e-6));
    CHECK(now.lost - before.lost == Approx(0.1 * def.loss / (sink + def.loss)).epsilon(1e-6));
    const double reach = std::sqrt(def.conductivity * def.depth / (sink + def.loss));
    for (const double x : {2e-3, 3e-3, 4e-3, 6e-3}) {
        const auto [warmth, r] = plate.near({x, 0, 0});
        // Outside of a disc that heats evenly: P / (2 pi k d) K0(r / l) 2 I1(a / l) / (a / l).
        const double a = 1e-3 / reach;
        const double law = 0.1 / (2.0 * pi * def.conductivity * def.depth) * std::cyl_bessel_k(0.0, r / reach) * 2.0 *
                           std::cyl_bessel_i(1.0, a) / a;
        CHECK(warmth == Approx(law).epsilon(0.05));
    }
}

TEST_CASE("heated everywhere, tissue warms, boils at 100 degrees until it is dry, and then chars")
{
    BurningDef def{.perfusion = 0.0, .loss = 0.0};
    Plate plate(def, 10e-3);
    const double capacity = def.density * def.depth * plate.area() * def.heatCapacity;
    const double latent = def.density * def.depth * plate.area() * def.water * 2.257e6;
    const double power = 200.0, toBoil = capacity * (373.15 - 310.15) / power, toDry = toBoil + latent / power;
    plate.heat.apply({.radius = kEverywhere, .power = power, .limit = 573.15}, {});
    plate.run(std::floor(toBoil));
    CHECK(plate.heat.temperature(0) == Approx(310.15 + power * std::floor(toBoil) / capacity).epsilon(1e-9));
    plate.run(2.0);
    for (int i = 0; i < 20; ++i) {
        CHECK(plate.heat.temperature(0) == Approx(373.15).epsilon(1e-12));
        plate.run(1.0);
    }
    const double boiling = std::floor(toBoil) + 22.0 - toBoil;
    REQUIRE(boiling < toDry);
    CHECK(plate.heat.water(0) == Approx(1.0 - boiling * power / latent).epsilon(1e-9));
    CHECK(plate.heat.balance().charred == 0.0);
    plate.run(toDry - boiling - toBoil + 1.0);
    CHECK(plate.heat.water(0) == 0.0);
    CHECK(plate.heat.balance().charred == Approx(plate.area()));
    CHECK(plate.heat.balance().hottest > 373.15);
    plate.run(200.0);
    CHECK(plate.heat.balance().hottest == Approx(573.15)); // and takes no more
    CHECK(plate.heat.balance().delivered == Approx(capacity * (573.15 - 310.15) + latent).epsilon(1e-6));
    CHECK(std::abs(error(plate.heat.balance())) < 1e-6 * plate.heat.balance().delivered);
    CHECK(plate.heat.levels()[0] == Approx(16.0 / 7.0)); // dry
}

TEST_CASE("what boils on a spot stays at 100 degrees while water is left, and heat is accounted for")
{
    Plate plate({}, 1e-3);
    plate.heat.apply({.radius = 2e-3, .power = 10.0}, {});
    double hottestWet = 0.0;
    for (int i = 0; i < 600; ++i) {
        plate.run(kStep);
        for (std::size_t v = 0; v < plate.mesh->vertices.size(); ++v)
            if (plate.heat.water(v) > 0.0) hottestWet = std::max(hottestWet, plate.heat.temperature(v));
    }
    CHECK(hottestWet == Approx(373.15).epsilon(1e-12));
    const HeatBalance now = plate.heat.balance();
    CHECK(now.charred > 0.0);
    CHECK(now.burnt > now.charred);
    CHECK(now.hottest <= 573.15 + 1e-9);
    CHECK(std::abs(error(now)) < 1e-6 * now.delivered);
}

TEST_CASE("damage at a constant temperature is Arrhenius' rate times the time")
{
    for (const double temperature : {320.0, 330.0, 340.0}) {
        Plate plate({.temperature = temperature}, 5e-3);
        plate.run(10.0);
        const double rate = 3.1e98 * std::exp(-6.28e5 / (8.314462618 * temperature));
        CHECK(plate.heat.damage(3) == Approx(rate * 10.0).epsilon(1e-6));
    }
    // Half a minute at 55 degrees Celsius, and a second at 60.
    CHECK(1.0 / damageRate(328.15, 3.1e98, 6.28e5) == Approx(29.5).epsilon(0.01));
    CHECK(1.0 / damageRate(333.15, 3.1e98, 6.28e5) == Approx(0.94).epsilon(0.01));
}

TEST_CASE("damage while the temperature changes is the integral of the rate, with few steps")
{
    const auto total = [](int steps) {
        double sum = 0.0;
        for (int i = 0; i < steps; ++i)
            sum += damageOver(310.0 + 50.0 * i / steps, 310.0 + 50.0 * (i + 1) / steps, 10.0 / steps, 3.1e98, 6.28e5);
        return sum;
    };
    CHECK(total(20) == Approx(total(20000)).epsilon(2e-3));
    CHECK(damageOver(330.0, 330.0, 2.0, 3.1e98, 6.28e5) == Approx(2.0 * damageRate(330.0, 3.1e98, 6.28e5)));
}

TEST_CASE("what is damaged blanches, is told, and is no longer perfused")
{
    Plate plate({}, 1e-3);
    plate.heat.apply({.radius = 3e-3, .power = 3.0, .limit = 360.0}, {});
    plate.run(20.0);
    plate.heat.apply({.power = 0.0}, {});
    plate.run(2.0);
    const HeatBalance now = plate.heat.balance();
    CHECK(now.burnt > 20e-6);
    CHECK(now.burnt < 100e-6);
    CHECK(now.charred == 0.0);
    CHECK(now.peak <= 360.0 + 1e-9);
    const std::vector<std::uint8_t> burnt = plate.heat.burnt();
    const std::vector<float> levels = plate.heat.levels();
    for (std::size_t v = 0; v < burnt.size(); ++v) CHECK((burnt[v] != 0) == (levels[v] >= 0.0F));
    CHECK(std::ranges::min(levels) < -0.8F); // far away it is nearly cold
}

TEST_CASE("the burnt area does not depend on the size of the triangles")
{
    const auto burnt = [](double edge) {
        Plate plate({}, edge, 0.02);
        plate.heat.apply({.radius = 3e-3, .power = 5.0, .limit = 370.0}, {});
        plate.run(10.0);
        return plate.heat.balance().burnt;
    };
    const double fine = burnt(0.25e-3);
    CHECK(burnt(0.5e-3) == Approx(fine).epsilon(0.05));
    CHECK(burnt(1e-3) == Approx(fine).epsilon(0.15));
}

TEST_CASE("a source is divided evenly over what it reaches, and one that touches nothing gives nothing")
{
    const auto mesh = geometry::shapes::sheet(0.04, 0.04, {5, 5});
    std::vector<HeatShare> shares;
    for (const double radius : {0.1e-3, 1e-3, 5e-3, kEverywhere}) { // triangles of 8 mm
        divideSource(mesh->triangles, mesh->vertices, {.points = {{3e-3, 0, 2e-3}}, .radius = radius}, shares);
        double sum = 0.0;
        Vec3 centre;
        for (const HeatShare& each : shares) {
            sum += each.share;
            centre = centre + each.share * mesh->vertices[each.vertex];
        }
        CHECK(sum == Approx(1.0));
        if (radius < 1.0) CHECK(distance(centre, {3e-3, 0, 2e-3}) < 0.1 * radius + 1e-4);
    }
    divideSource(mesh->triangles, mesh->vertices, {.points = {{0, 2e-3, 0}}, .radius = 1e-3}, shares);
    CHECK(shares.empty());

    Plate plate({}, 2e-3);
    plate.heat.apply({.place = {0, 5e-3, 0}, .radius = 1e-3, .power = 10.0}, {});
    plate.run(1.0);
    CHECK(plate.heat.balance().delivered == 0.0);
}

TEST_CASE("a source along a line or between two heats what is within its reach, evenly")
{
    const auto mesh = geometry::shapes::sheet(0.04, 0.04, {40, 40});
    std::vector<HeatShare> shares;
    const auto centre = [&] {
        Vec3 sum;
        double all = 0.0;
        for (const HeatShare& each : shares) {
            sum = sum + each.share * mesh->vertices[each.vertex];
            all += each.share;
        }
        CHECK(all == Approx(1.0));
        return sum;
    };
    constexpr double kRadius = 2e-3, kLength = 10e-3, kWidth = 6e-3;
    const Vec3 a{-3e-3, 0, 1e-3}, b = a + Vec3{kLength, 0, 0};
    const HeatReach line{.points = {a, b}, .radius = kRadius};
    const double area = divideSource(mesh->triangles, mesh->vertices, line, shares);
    CHECK(area == Approx(2.0 * kRadius * kLength + pi * kRadius * kRadius).epsilon(0.02));
    CHECK(distance(centre(), 0.5 * (a + b)) < 0.1e-3);

    const Vec3 across{0, 0, kWidth};
    const HeatReach band{.points = {a, b, b + across, a + across}, .filled = true, .radius = kRadius};
    const double wide = divideSource(mesh->triangles, mesh->vertices, band, shares);
    CHECK(wide ==
          Approx((kLength + 2 * kRadius) * (kWidth + 2 * kRadius) - (4 - pi) * kRadius * kRadius).epsilon(0.02));
    CHECK(distance(centre(), 0.5 * (a + b + across)) < 0.1e-3);

    // Around a right angle: two lines, whose corner counts once, and is round outside.
    const HeatReach bent{.points = {a, b, b + across}, .radius = kRadius};
    CHECK(divideSource(mesh->triangles, mesh->vertices, bent, shares) ==
          Approx(2.0 * kRadius * (kLength + kWidth) + (1.25 * pi - 1.0) * kRadius * kRadius).epsilon(0.02));
    const Vec3 ends = (kLength * 0.5 * (a + b) + kWidth * (b + 0.5 * across)) / (kLength + kWidth);
    CHECK(distance(centre(), ends) < 0.6e-3);

    // Above the surface it reaches less of it, and only grazes it in the end.
    HeatReach above = line;
    for (Vec3& each : above.points) each.y = 1.2e-3;
    CHECK(divideSource(mesh->triangles, mesh->vertices, above, shares) ==
          Approx(2.0 * 1.6e-3 * kLength + pi * 1.6e-3 * 1.6e-3).epsilon(0.05));
    for (Vec3& each : above.points) each.y = kRadius - 1e-9;
    CHECK(divideSource(mesh->triangles, mesh->vertices, above, shares) == 0.0);
    CHECK(std::abs(centre().z - a.z) < 1e-3);
    for (Vec3& each : above.points) each.y = kRadius + 1e-9;
    CHECK(divideSource(mesh->triangles, mesh->vertices, above, shares) == 0.0);
    CHECK(shares.empty());
}

TEST_CASE("a tip that is held still heats as a disc source, and what it gave is known")
{
    const BurningDef def = conducting();
    constexpr double kPower = 0.2, kRadius = 3e-3, kTime = 20.0;
    Plate plate(def, 1e-3);
    std::vector<HeatShare> shares;
    divideSource(plate.mesh->triangles, plate.mesh->vertices, {.radius = kRadius}, shares);
    for (int i = 0; i < std::lround(kTime / kStep); ++i) {
        plate.heat.touch({{.electrode = 7, .energy = kPower * kStep, .limit = 1000.0, .shares = shares}});
        plate.run(kStep);
    }
    for (const double x : {0.0, 2e-3, 4e-3}) {
        const auto [warmth, r] = plate.near({x, 0, 0});
        CHECK(warmth == Approx(fromDisc(def, kPower, kRadius, r, kTime)).epsilon(0.03));
    }
    CHECK(plate.heat.balance().delivered == Approx(kPower * kTime).epsilon(1e-9));
    CHECK(plate.heat.taken().at(7) == Approx(kPower * kTime).epsilon(1e-9));
    CHECK(std::abs(error(plate.heat.balance())) < 1e-9 * kPower * kTime);
    plate.run(1.0); // it has gone
    CHECK(plate.heat.balance().delivered == Approx(kPower * kTime).epsilon(1e-9));
}

TEST_CASE("tissue that takes less than two tips offer takes from each in proportion")
{
    Plate plate({.perfusion = 0.0, .loss = 0.0, .water = 0.0}, 5e-3);
    std::vector<HeatShare> shares;
    divideSource(plate.mesh->triangles, plate.mesh->vertices, {.radius = kEverywhere}, shares);
    const double room = 1060.0 * 3540.0 * 0.002 * plate.area() * 50.0; // [J] to 50 K above rest
    for (int i = 0; i < 10; ++i) {
        plate.heat.touch({{.electrode = 0, .energy = 0.3 * room, .limit = 360.15, .shares = shares},
                          {.electrode = 1, .energy = 0.1 * room, .limit = 360.15, .shares = shares}});
        plate.run(kStep);
    }
    CHECK(plate.heat.balance().delivered == Approx(room).epsilon(1e-6));
    CHECK(plate.heat.taken().at(0) == Approx(0.75 * room).epsilon(1e-6));
    CHECK(plate.heat.taken().at(1) == Approx(0.25 * room).epsilon(1e-6));
}

TEST_CASE("sources of different numbers heat together, and a cut keeps the burn and accounts for the heat")
{
    Plate plate({}, 2e-3);
    plate.heat.apply({.place = {5e-3, 0, 0}, .power = 1.0}, {});
    plate.heat.apply({.place = {-5e-3, 0, 0}, .power = 2.0, .source = 1}, {});
    plate.run(1.0);
    CHECK(plate.heat.balance().delivered == Approx(3.0));
    const HeatBalance before = plate.heat.balance();
    // Half of it is gone.
    frame::Boundary half{.revision = 1, .rest = plate.mesh->vertices};
    for (const geometry::Triangle& t : plate.mesh->triangles)
        if (plate.mesh->vertices[t[0]].x + plate.mesh->vertices[t[1]].x + plate.mesh->vertices[t[2]].x > 0.0)
            half.triangles.push_back(t);
    half.opened.assign(half.triangles.size(), 0);
    plate.heat.follow(half);
    CHECK(plate.heat.balance().carriedOff == Approx(before.stored * 2.0 / 3.0).epsilon(0.05));
    plate.run(1.0);
    CHECK(plate.heat.balance().delivered == Approx(4.0)); // there is nothing left for the second
    CHECK(std::abs(error(plate.heat.balance())) < 1e-9);
    plate.heat.follow({.revision = 0});
    CHECK(plate.heat.balance() == Burning({}, plate.mesh->triangles, "plate").balance());
}

TEST_CASE("nothing happens while nothing is warm, and bad numbers are one clear error")
{
    Plate plate({}, 5e-3);
    plate.run(10.0);
    CHECK(plate.heat.balance() == HeatBalance{.hottest = 310.15, .peak = 310.15});
    CHECK_THROWS_WITH(Plate({.depth = 0.0}, 5e-3), Catch::Contains("plate: depth must be > 0 m, got 0"));
    CHECK_THROWS_WITH(Plate({.temperature = 37.0}, 5e-3),
                      Catch::Contains("plate: temperature must be in [250, 370] K, got 37"));
    CHECK_THROWS_WITH(Burning({}, {}, "x"), "x: needs a surface of triangles, got none");
}

} // namespace burning_test
