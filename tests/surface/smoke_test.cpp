#include "filasofia/surface/smoke.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/math/gaussian.h"
#include "filasofia/surface/burning.h"
#include "filasofia/surface/heat.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <numbers>

namespace smoke_test {
using namespace filasofia;
using namespace filasofia::surface;
using std::numbers::pi;

constexpr double kForever = std::numeric_limits<double>::infinity();
constexpr double kStep = 1.0 / 60.0;
constexpr Vec3 kGravity{0.0, -9.81, 0.0};

/// 4 litres, in which nothing happens by itself.
SmokeDef still()
{
    return {.room = {{-0.1, -0.1, -0.05}, {0.1, 0.1, 0.05}},
            .settling = kForever,
            .drying = kForever,
            .warmth = 0.0,
            .diffusivity = 0.0,
            .mixing = kForever};
}
constexpr double kVolume = 0.2 * 0.2 * 0.1;

double error(const AerosolBalance& b) { return b.emitted - b.inAir - b.extracted - b.vented - b.settled; }

void run(Smoke& smoke, double seconds)
{
    for (int i = 0; i < std::lround(seconds / kStep); ++i) smoke.step(kGravity, kStep);
}

TEST_CASE("what hot tissue takes becomes smoke, and what boils becomes droplets")
{
    SmokeDef def = still();
    def.yield = 2e-8;
    def.steam = 0.2;
    Smoke smoke(def, "smoke");
    smoke.emit({.taken = 10.0, .boiled = 4.0});
    smoke.step(kGravity, kStep);
    CHECK(smoke.balance().smoke.emitted == Approx(2e-7).epsilon(1e-12));
    CHECK(smoke.balance().smoke.inAir == Approx(2e-7).epsilon(1e-12));
    CHECK(smoke.balance().steam.emitted == Approx(0.2 * 4.0 / kLatentHeat).epsilon(1e-12));
    smoke.step(kGravity, kStep);
    CHECK(smoke.balance().smoke.emitted == Approx(2e-7).epsilon(1e-12)); // given off once
}

TEST_CASE("fresh gas and settling thin smoke out exponentially, and a steady source fills to its rate by their time")
{
    SmokeDef def = still();
    def.inflow = 10.0 / 60.0 * 1e-3; // 10 l/min
    def.settling = 40.0;
    def.mixing = 3.0;
    const double rate = def.inflow / kVolume + 1.0 / def.settling;
    Smoke smoke(def, "smoke");
    double given = 0.0;
    for (int i = 0; i < 60 * 30; ++i) { // 20 W for half a minute
        smoke.emit({.place = {0, -0.05, 0}, .taken = 20.0 * kStep, .boiled = 0.0});
        smoke.step(kGravity, kStep);
        given += 20.0 * kStep * def.yield;
    }
    const AerosolBalance full = smoke.balance().smoke;
    CHECK(full.emitted == Approx(given).epsilon(1e-12));
    CHECK(full.inAir == Approx(20.0 * def.yield / rate * (1.0 - std::exp(-rate * 30.0))).epsilon(1e-9));
    CHECK(std::abs(error(full)) < 1e-12 * full.emitted);
    run(smoke, 20.0);
    const AerosolBalance after = smoke.balance().smoke;
    CHECK(after.inAir == Approx(full.inAir * std::exp(-rate * 20.0)).epsilon(1e-9));
    CHECK(after.vented / after.settled == Approx(def.inflow / kVolume * def.settling).epsilon(1e-9));
    CHECK(std::abs(error(after)) < 1e-12 * after.emitted);
}

TEST_CASE("a warm puff rises as a thermal does, whatever the step")
{
    const double entrainment = 0.25, buoyancy = 3e-6, start = 0.004, seconds = 1.5;
    for (const int steps : {1, 7, 900}) {
        Puff puff{.radius = start, .buoyancy = buoyancy};
        double height = 0.0;
        for (int i = 0; i < steps; ++i) height += rise(puff, entrainment, seconds / steps);
        const double r0 = 2.0 * start;
        const double r =
            std::pow(std::pow(r0, 4) + 1.5 * entrainment * buoyancy / pi * seconds * seconds, 0.25); // closed form
        CHECK(2.0 * puff.radius == Approx(r).epsilon(1e-9));
        CHECK(puff.speed == Approx(3.0 * buoyancy * seconds / (4.0 * pi * r * r * r)).epsilon(1e-9));
        CHECK(height == Approx((r - r0) / entrainment).epsilon(1e-9));
    }
    // The same by its laws alone, in very small steps: momentum grows by the buoyancy, the radius by the way.
    double r = 2.0 * start, momentum = 0.0, height = 0.0;
    const int many = 200000;
    for (int i = 0; i < many; ++i) {
        momentum += 3.0 * buoyancy / (4.0 * pi) * seconds / many;
        const double way = momentum / (r * r * r) * seconds / many;
        r += entrainment * way;
        height += way;
    }
    Puff puff{.radius = start, .buoyancy = buoyancy};
    CHECK(rise(puff, entrainment, seconds) == Approx(height).epsilon(1e-3));
}

TEST_CASE("smoke rises to the ceiling, stays in the room, and spreads by diffusion")
{
    SmokeDef def = still();
    def.warmth = 0.05;
    Smoke smoke(def, "smoke");
    smoke.emit({.place = {0, -0.09, 0}, .taken = 4.0});
    smoke.step(kGravity, kStep);
    const double low = smoke.puffs().at(0).place.y;
    run(smoke, 0.5);
    CHECK(smoke.puffs().at(0).place.y > low + 0.03);
    run(smoke, 10.0);
    CHECK(smoke.puffs().at(0).place.y == 0.1);
    CHECK(smoke.puffs().at(0).speed == 0.0);
    CHECK(std::abs(smoke.puffs().at(0).place.x) <= 0.1);

    def.warmth = 0.0;
    def.diffusivity = 1e-5;
    Smoke cold(def, "smoke");
    cold.emit({.taken = 1.0});
    cold.step(kGravity, kStep);
    run(cold, 10.0);
    CHECK(cold.puffs().at(0).radius == Approx(std::sqrt(def.radius * def.radius + 2e-5 * 10.0)).epsilon(1e-9));
    CHECK(length(cold.puffs().at(0).place) < 1e-12);
}

TEST_CASE("an opening takes what is in the gas that it takes")
{
    constexpr double kFlow = 5.0 / 60.0 * 1e-3; // 5 l/min
    const auto suck = [](Smoke& smoke, Vec3 place, double seconds) {
        for (int i = 0; i < std::lround(seconds / kStep); ++i) {
            smoke.extract(place, kFlow);
            smoke.step(kGravity, kStep);
        }
        CHECK(std::abs(error(smoke.balance().smoke)) < 1e-12 * smoke.balance().smoke.emitted);
        return smoke.balance().smoke;
    };
    SmokeDef def = still();
    def.radius = 0.012;
    Smoke there(def, "smoke"), aside(def, "smoke");
    for (Smoke* each : {&there, &aside}) {
        each->emit({.taken = 10.0});
        each->step(kGravity, kStep);
    }
    // A cloud around the opening: its density there times the flow.
    const double density = 1.0 / (std::pow(2.0 * pi, 1.5) * std::pow(def.radius, 3));
    const AerosolBalance taken = suck(there, {}, 0.2);
    CHECK(taken.extracted == Approx(taken.emitted * (1.0 - std::exp(-kFlow * density * 0.2))).epsilon(1e-6));
    // One beside it is drawn near, as the gas of a sink is.
    const AerosolBalance less = suck(aside, {0.04, 0, 0}, 0.2);
    CHECK(less.extracted < 0.2 * taken.extracted);
    CHECK(aside.puffs().at(0).place.x ==
          Approx(0.04 - std::cbrt(std::pow(0.04, 3) - 3.0 * kFlow * 0.2 / (4.0 * pi))).epsilon(1e-9));

    // One outside the closed room takes nothing.
    CHECK(suck(there, {0, 0.11, 0}, 1.0).extracted == taken.extracted);

    // What has mixed with the room: flow over volume.
    def.mixing = 1e-3;
    Smoke mixed(def, "smoke");
    mixed.emit({.taken = 10.0});
    run(mixed, 0.5);
    CHECK(mixed.puffs().empty());
    const AerosolBalance air = suck(mixed, {0.09, 0, 0}, 30.0);
    CHECK(air.inAir == Approx(air.emitted * std::exp(-kFlow / kVolume * 30.0)).epsilon(1e-6));
}

TEST_CASE("the optical depth is the integral of mass and extinction along the way")
{
    SmokeDef def = still();
    def.mixing = 5.0;
    Smoke smoke(def, "smoke");
    smoke.emit({.place = {0.01, 0, 0}, .taken = 30.0, .boiled = 20.0});
    run(smoke, 3.0);
    REQUIRE(smoke.puffs().size() == 1);
    const Puff& puff = smoke.puffs()[0];
    const Vec3 from{-0.03, 0.002, 0.04}, to{0.02, -0.001, -0.045};
    const int many = 20000;
    double sum = 0.0;
    for (int i = 0; i < many; ++i) {
        const Vec3 at = from + (i + 0.5) / many * (to - from);
        const double density = std::exp(-0.5 * lengthSquared(at - puff.place) / (puff.radius * puff.radius)) /
                               (std::pow(2.0 * pi, 1.5) * std::pow(puff.radius, 3));
        sum += (smoke.extinction(puff) * density + smoke.haze()) * length(to - from) / many;
    }
    CHECK(smoke.opticalDepth(from, to) == Approx(sum).epsilon(1e-6));
    CHECK(smoke.opticalDepth({-0.3, 0.05, 0}, {0.3, 0.05, 0}) == Approx(smoke.haze() * 0.2).epsilon(1e-6)); // the room
    CHECK(smoke.opticalDepth(from, from) == 0.0);
    const SmokeBalance all = smoke.balance();
    CHECK(smoke.extinction(puff) + smoke.haze() * kVolume ==
          Approx(def.extinction * all.smoke.inAir + def.steamExtinction * all.steam.inAir).epsilon(1e-12));
}

TEST_CASE("mass is kept whatever happens, for a bounded number of puffs, with the same bits each time")
{
    const auto operate = [] {
        Smoke smoke({.room = {{-0.1, -0.1, -0.05}, {0.1, 0.1, 0.05}}, .inflow = 1e-4}, "smoke");
        for (int i = 0; i < 60 * 60; ++i) {
            const double t = i * kStep, x = 0.08 * std::sin(t);
            if (i % 300 < 200) smoke.emit({.place = {x, -0.1, 0}, .taken = 0.5, .boiled = 0.4});
            if (i % 2 == 0) smoke.emit({.place = {-x, -0.1, 0.05}, .taken = 0.1, .boiled = 0.0});
            if (i > 1000) smoke.extract({0, 0.05, 0}, 2e-4);
            smoke.step(kGravity, kStep);
            CHECK(smoke.puffs().size() <= 64);
        }
        return smoke;
    };
    const Smoke smoke = operate();
    const SmokeBalance b = smoke.balance();
    CHECK(b.smoke.extracted > 0.1 * b.smoke.emitted);
    CHECK(std::abs(error(b.smoke)) < 1e-11 * b.smoke.emitted);
    CHECK(std::abs(error(b.steam)) < 1e-11 * b.steam.emitted);
    for (const Puff& puff : smoke.puffs())
        CHECK((std::abs(puff.place.x) <= 0.1 && std::abs(puff.place.y) <= 0.1 && std::abs(puff.place.z) <= 0.05));
    CHECK(operate().balance() == b);
    CHECK(operate().opticalDepth({0, 0, 0}, {0.1, 0.1, 0}) == smoke.opticalDepth({0, 0, 0}, {0.1, 0.1, 0}));
}

TEST_CASE("a wrong room or number is an Error")
{
    using Catch::Contains;
    CHECK_THROWS_WITH(Smoke({}, "smoke"), Contains("smoke: room must be given, with room.low < room.high"));
    CHECK_THROWS_WITH(Smoke({.room = {{0, 0, 0}, {1, 0, 1}}}, "smoke"), Contains("room.high must be > room.low"));
    SmokeDef def = still();
    def.yield = -1.0;
    CHECK_THROWS_WITH(Smoke(def, "smoke"), Contains("smoke: yield must be in [0, 0.001] kg/J, got -1"));
    def = still();
    def.settling = 0.0;
    CHECK_THROWS_WITH(Smoke(def, "smoke"), Contains("settling must be > 0"));
}

TEST_CASE("tissue at the boiling point fumes, and no other")
{
    const auto mesh = geometry::shapes::sheet(0.04, 0.04, {40, 40});
    Burning burning({.depth = 0.0005}, mesh->triangles, "plate");
    burning.apply({.place = {0.01, 0, 0}, .radius = 0.002, .power = 1.0}, mesh->vertices);
    burning.step(mesh->vertices, {}, kStep);
    CHECK(burning.takeFumes().empty()); // warm
    burning.apply({.place = {0.01, 0, 0}, .radius = 0.002, .power = 30.0}, mesh->vertices);
    double taken = 0.0, boiled = 0.0;
    for (int i = 0; i < 60; ++i) {
        burning.step(mesh->vertices, {}, kStep);
        for (const Fume& each : burning.takeFumes()) {
            taken += each.taken;
            boiled += each.boiled;
            CHECK(distance(each.place, {0.01, 0, 0}) < 0.008);
        }
        CHECK(burning.takeFumes().empty()); // they are handed out once, however often they are asked for
    }
    const HeatBalance heat = burning.balance();
    CHECK(taken > 5.0);
    CHECK(taken == Approx(heat.fuming).epsilon(1e-12));
    CHECK(boiled == Approx(heat.boiled).epsilon(1e-12));
    CHECK(heat.fuming <= heat.delivered);
    burning.apply({.place = {0.01, 0, 0}, .power = 0.0}, mesh->vertices);
    for (int i = 0; i < 120; ++i) burning.step(mesh->vertices, {}, kStep);
    CHECK(burning.takeFumes().empty());
}

} // namespace smoke_test
