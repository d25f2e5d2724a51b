#include "filasofia/surface/distension.h"

#include "filasofia/core/error.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <numbers>

namespace distension_test {
using namespace filasofia;
using namespace filasofia::surface;

constexpr double kStep = 1.0 / 60.0;
constexpr Vec3 kGravity{0.0, -9.81, 0.0};
const geometry::Box kRoom{{-0.02, -0.01, -0.02}, {0.02, 0.01, 0.02}};

DistensionDef flowing()
{
    return {.room = kRoom, .volume = 1e-5, .compliance = 1e-9, .pressure = 12e3, .outflow = 1.0};
}

double error(const DistensionBalance& b) { return b.atStart + b.in + b.bled - b.out - b.lost - b.volume; }

void run(Distension& fluid, double seconds, double bleeding = 0.0, double dt = kStep)
{
    for (int i = 0; i < std::lround(seconds / dt); ++i) {
        fluid.bleed(bleeding * dt);
        fluid.step(kGravity, dt);
    }
}

TEST_CASE("a distended cavity comes to the pressure at which as much flows in as out, each by its resistance")
{
    Distension fluid(flowing(), "distension");
    run(fluid, 60.0);
    const DistensionBalance b = fluid.balance();
    CHECK(b.pressure == Approx(12e3 * 4.0 / 6.0).epsilon(1e-9)); // a divider of 2 and 4 GPa s/m^3
    CHECK(b.inflow == Approx((12e3 - b.pressure) / 2e9).epsilon(1e-12));
    CHECK(b.outflow == Approx(b.pressure / 4e9).epsilon(1e-12));
    CHECK(b.inflow == Approx(b.outflow).epsilon(1e-9));
    CHECK(b.volume == Approx(1e-5 + 1e-9 * b.pressure).epsilon(1e-9));
}

TEST_CASE("a cavity fills exponentially, with the same numbers for steps of any length")
{
    DistensionDef def = flowing();
    def.outflow = 0.0;
    for (const double dt : {1e-3, kStep, 0.5, 2.0}) {
        Distension fluid(def, "distension");
        run(fluid, 2.0, 0.0, dt);
        CHECK(fluid.balance().pressure == Approx(12e3 * -std::expm1(-2.0 / (2e9 * 1e-9))).epsilon(1e-9));
        CHECK(deficit(fluid.balance()) == Approx(1e-9 * fluid.balance().pressure).epsilon(1e-9));
    }
}

TEST_CASE("a leak opens at its pressure, in the middle of a step too, and what it loses is a deficit")
{
    DistensionDef def = flowing();
    def.outflow = 0.0;
    def.leakPressure = 6e3;
    def.leakResistance = 2e9;
    def.deficitLimit = 2e-5;
    Distension once(def, "distension"), often(def, "distension");
    run(once, 4.0, 0.0, 4.0);
    run(often, 4.0, 0.0, 1e-3);
    // It reaches 6 kPa after tau ln 2, and then goes to the middle of both, with half the time constant.
    const double left = 4.0 - 2.0 * std::numbers::ln2;
    CHECK(once.balance().pressure == Approx(9e3 - 3e3 * std::exp(-left)).epsilon(1e-9));
    CHECK(often.balance().pressure == Approx(once.balance().pressure).epsilon(1e-9));
    CHECK(often.balance().lost == Approx(once.balance().lost).epsilon(1e-9));
    CHECK(once.balance().lost == Approx((3e3 * left - 3e3 * -std::expm1(-left)) / 2e9).epsilon(1e-9));
    CHECK_FALSE(once.balance().beyondLimit);
    run(once, 20.0);
    CHECK(once.balance().beyondLimit);
    CHECK(deficit(once.balance()) == Approx(once.balance().lost + 1e-9 * once.balance().pressure).epsilon(1e-9));
}

TEST_CASE("nothing flows back into the bag, and blood alone raises the pressure along a straight line")
{
    DistensionDef def = flowing();
    def.pressure = 1e3;
    def.outflow = 0.0;
    def.leakPressure = 1e6;
    Distension fluid(def, "distension");
    run(fluid, 60.0);
    const double in = fluid.balance().in;
    run(fluid, 10.0, 1e-6);
    CHECK(fluid.balance().in == Approx(in).epsilon(1e-9));
    CHECK(fluid.balance().pressure == Approx(1e3 + 1e-5 / 1e-9).epsilon(1e-9));
}

TEST_CASE("a steady bleed clouds the fluid to its share of the flow, and the flow clears it by volume over flow")
{
    Distension fluid(flowing(), "distension");
    run(fluid, 60.0);
    const double bleeding = 2e-8;
    run(fluid, 200.0, bleeding);
    const DistensionBalance steady = fluid.balance();
    CHECK(bloodShare(steady) == Approx(bleeding / steady.outflow).epsilon(1e-6));
    CHECK(fluid.haze() == Approx(6000.0 * bloodShare(steady)).epsilon(1e-12));
    run(fluid, 20.0); // the pressure is steady again, nearly at once
    const double from = bloodShare(fluid.balance());
    run(fluid, 6.0);
    const DistensionBalance b = fluid.balance();
    CHECK(bloodShare(b) / from == Approx(std::exp(-6.0 * b.outflow / b.volume)).epsilon(1e-6));
    CHECK(from > 0.0);
}

TEST_CASE("a minute of everything keeps the volume")
{
    DistensionDef def = flowing();
    def.leakResistance = 3e9;
    def.leakPressure = 5e3;
    Distension fluid(def, "distension");
    for (int second = 0; second < 60; ++second) {
        fluid.apply({.pressure = second % 3 * 6e3, .inflow = second % 2 * 1.0, .outflow = second % 5 / 4.0});
        run(fluid, 1.0, second % 7 * 1e-7);
    }
    const DistensionBalance b = fluid.balance();
    CHECK(b.in > 1e-5);
    CHECK(b.out > 1e-5);
    CHECK(b.lost > 1e-6);
    CHECK(std::abs(error(b)) < 1e-6 * b.volume);
    CHECK(b.volume == Approx(1e-5 + 1e-9 * b.pressure).epsilon(1e-6)); // volume and pressure are told apart
    CHECK(b.blood > 0.0);
    CHECK(b.blood < b.bled);
}

TEST_CASE("what an electrode gives becomes bubbles, which rise at their pace and gather at the top")
{
    DistensionDef def = flowing();
    def.outflow = 0.0;
    def.bubbleLife = std::numeric_limits<double>::infinity();
    Distension fluid(def, "distension");
    fluid.heat({0.005, -0.008, 0.0}, 20.0);
    fluid.step(kGravity, kStep);
    REQUIRE(fluid.bubbles().size() > 3);
    CHECK(fluid.balance().gasFormed == Approx(20.0 * def.gas).epsilon(1e-12));
    CHECK(fluid.balance().gas == Approx(fluid.balance().gasFormed).epsilon(1e-12));
    const Bubble first = fluid.bubbles().front();
    fluid.step(kGravity, kStep);
    CHECK(fluid.bubbles().front().place.y - first.place.y ==
          Approx(kStep * risingSpeed(radiusOf(first), 9.81)).epsilon(0.3)); // others may push it a little
    run(fluid, 5.0);
    for (const Bubble& each : fluid.bubbles()) CHECK(each.place.y > 0.008);
    CHECK(fluid.balance().gas == Approx(fluid.balance().gasFormed).epsilon(1e-9));
}

TEST_CASE("a bubble rises as a rigid sphere in water: by Stokes if it is tiny, and by measured drag if it is larger")
{
    CHECK(risingSpeed(10e-6, 9.81) == Approx(2.0 / 9.0 * 9.81 * 1e-10 / 1e-6).epsilon(0.02));
    const double speed = risingSpeed(0.5e-3, 9.81), reynolds = speed * 1e-3 / 1e-6;
    CHECK(reynolds * (1.0 + 0.15 * std::pow(reynolds, 0.687)) == Approx(9.81 * 1e-9 / 18e-12).epsilon(1e-9));
    CHECK(risingSpeed(0.1, 9.81) > speed);
}

TEST_CASE("bubbles dissolve and leave with the outflow, and there are never too many")
{
    DistensionDef def = flowing();
    def.bubbleLife = 5.0;
    Distension fluid(def, "distension");
    run(fluid, 60.0);
    for (int i = 0; i < 600; ++i) {
        fluid.heat({}, 1.0);
        fluid.step(kGravity, kStep);
        CHECK(fluid.bubbles().size() <= Distension::kMostBubbles);
    }
    const Bubble before = fluid.bubbles().back();
    run(fluid, 2.0);
    const Bubble after = fluid.bubbles().back();
    REQUIRE(after.number == before.number);
    const DistensionBalance b = fluid.balance();
    CHECK(after.volume / before.volume == Approx(std::exp(-2.0 * (b.outflow / b.volume + 1.0 / 5.0))).epsilon(1e-6));
    run(fluid, 120.0);
    CHECK(fluid.bubbles().empty());
}

TEST_CASE("the same calls give the same fluid")
{
    const auto made = [] {
        Distension fluid(flowing(), "distension");
        for (int i = 0; i < 300; ++i) {
            fluid.heat({0.001 * (i % 5), 0.0, 0.0}, 0.5);
            fluid.bleed(1e-9);
            fluid.step(kGravity, kStep);
        }
        return fluid;
    };
    const Distension one = made(), two = made();
    CHECK(one.balance() == two.balance());
    REQUIRE(one.bubbles().size() == two.bubbles().size());
    for (std::size_t i = 0; i < one.bubbles().size(); ++i) CHECK(one.bubbles()[i].place == two.bubbles()[i].place);
}

TEST_CASE("a wrong distension is one clear error")
{
    using Catch::Contains;
    const auto made = [](auto&& change) {
        DistensionDef def = flowing();
        change(def);
        return Distension(def, "distension");
    };
    CHECK_THROWS_WITH(made([](auto& def) { def.room = {}; }), Contains("distension: room must be given"));
    CHECK_THROWS_WITH(made([](auto& def) { def.room.high.y = -0.01; }),
                      Contains("distension: room.high must be > room.low in every axis"));
    CHECK_THROWS_WITH(made([](auto& def) { def.compliance = 0.0; }),
                      Contains("compliance must be in (0, 1] m^3/Pa, got 0"));
    CHECK_THROWS_WITH(made([](auto& def) { def.outflow = 1.5; }), Contains("outflow must be in [0, 1]"));
    CHECK_THROWS_WITH(made([](auto& def) { def.up = Vec3{}; }), Contains("distension: up must have a length > 0"));
}

} // namespace distension_test
