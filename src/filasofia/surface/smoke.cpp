#include "filasofia/surface/smoke.h"

#include "filasofia/core/hash.h"
#include "filasofia/geometry/box.h"
#include "filasofia/math/gaussian.h"
#include "filasofia/surface/checked_room.h"
#include "filasofia/surface/heat.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace filasofia::surface {
namespace {

constexpr std::size_t kMostPuffs = 64;           ///< older ones join what has mixed with the room
constexpr double kJoin = 0.2;                    ///< [s], in which what is given off at a place makes one puff
constexpr double kJoinWithin = 0.012;            ///< [m], and so near to it
constexpr double kOld = 3.0;                     ///< mixing times, after which the rest of a puff joins the room's
constexpr double kGasHeat = 1.8 * 850.0 * 310.0; ///< [J/m^3], density, heat capacity and temperature of carbon dioxide
constexpr double kWander = 0.5;                  ///< [s], in which the draught turns
constexpr double kMostDrift = 0.45;              ///< [-], strongest drift aside per way up
constexpr double kWidest = 0.25;                 ///< [-], radius of a puff over the smallest side of the room, at most

/// A number in [-1, 1] that is the same for the same seed, tick and axis.
double chance(int seed, std::int64_t tick, int axis)
{
    Hasher bits;
    bits.add(static_cast<std::uint64_t>(seed));
    bits.add(static_cast<std::uint64_t>(tick));
    bits.add(static_cast<std::uint64_t>(axis));
    return static_cast<double>(bits.value() >> 11U) * 0x1p-52 - 1.0;
}

/// A slow draught along an axis, smooth over time.
double draught(int seed, double time, int axis)
{
    const double at = time / kWander, from = std::floor(at), share = at - from;
    const auto tick = static_cast<std::int64_t>(from);
    const double weight = share * share * (3.0 - 2.0 * share);
    return (1.0 - weight) * chance(seed, tick, axis) + weight * chance(seed, tick + 1, axis);
}

/// The share of something given off evenly over `dt` that is still there, if it falls at `rate` [1/s].
double shareLeft(double rate, double dt)
{
    const double x = rate * dt;
    return x > 1e-9 ? -std::expm1(-x) / x : 1.0;
}

} // namespace

double rise(Puff& puff, double entrainment, double dt)
{
    // d(r^3 w)/dt = 3 B / (4 pi), dr/dt = a w, with the radius r of two standard deviations.
    const double r = 2.0 * puff.radius, momentum = r * r * r * puff.speed;
    const double push = 3.0 * puff.buoyancy / (4.0 * std::numbers::pi);
    const double fourth = r * r * r * r + 4.0 * entrainment * (momentum * dt + 0.5 * push * dt * dt);
    const double after = std::sqrt(std::sqrt(fourth));
    puff.radius = 0.5 * after;
    puff.speed = (momentum + push * dt) / (after * after * after);
    return (after - r) / entrainment;
}

Smoke::Smoke(const SmokeDef& def, const std::string& object) : def_(def)
{
    validateWithRoom(def_, object, "smoke stays in it");
}

double Smoke::volume() const
{
    const Vec3 size = def_.room.high - def_.room.low;
    return size.x * size.y * size.z;
}

void Smoke::emit(const Fume& fume) { fumes_.push_back(fume); }
void Smoke::extract(Vec3 place, double flow)
{
    if (geometry::contains(def_.room, place)) openings_.push_back({place, flow});
}

void Smoke::step(Vec3 gravity, double dt)
{
    const double pull = length(gravity);
    const Vec3 up = pull > 0.0 ? -1.0 / pull * gravity : Vec3{};
    if (dt > 0.0) {
        thin(dt);
        move(up, dt);
        suck(dt);
        for (const Fume& each : fumes_) add(each, up, pull, dt);
        time_ += dt;
        mixOld();
        fumes_.clear();
    }
    openings_.clear();
}

/// What fresh gas pushes out, what settles or dries, and what the room's stirring takes from puffs.
void Smoke::thin(double dt)
{
    const double vent = def_.inflow / volume();
    const double stir = -std::expm1(-dt / def_.mixing);
    for (std::size_t a = 0; a < mixed_.size(); ++a) {
        const double settle = 1.0 / (a == 0 ? def_.settling : def_.drying), rate = vent + settle;
        const double lost = -std::expm1(-rate * dt);
        const auto lose = [&](double& mass) {
            const double gone = mass * lost;
            mass -= gone;
            balance_[a].vented += gone * vent / rate;
            balance_[a].settled += gone * settle / rate;
        };
        if (rate > 0.0) lose(mixed_[a]);
        for (Puff& puff : puffs_) {
            if (rate > 0.0) lose(puff.mass[a]);
            const double stirred = puff.mass[a] * stir;
            puff.mass[a] -= stirred;
            mixed_[a] += stirred;
        }
    }
}

/// Puffs rise, drift, spread, and stay in the room: below its ceiling they come to rest.
void Smoke::move(Vec3 up, double dt)
{
    const Vec3 size = def_.room.high - def_.room.low;
    const double widest = kWidest * std::min({size.x, size.y, size.z});
    for (Puff& puff : puffs_) {
        puff.age += dt;
        const Vec3 to = puff.place + rise(puff, def_.entrainment, dt) * (up + puff.drift);
        puff.place = max(def_.room.low, min(def_.room.high, to));
        if (dot(puff.place, up) < dot(to, up)) puff.speed = puff.buoyancy = 0.0;
        const double before = puff.radius;
        puff.radius = std::min(std::sqrt(before * before + 2.0 * def_.diffusivity * dt), std::max(widest, def_.radius));
        puff.speed *= std::pow(before / puff.radius, 3); // the momentum stays
    }
}

/// An opening draws gas in from all sides, as a sink does, and takes what is in the gas that it takes.
void Smoke::suck(double dt)
{
    for (const Opening& opening : openings_) {
        if (!(opening.flow > 0.0)) continue;
        const auto take = [&](std::size_t a, double& mass, double share) {
            const double gone = mass * share;
            mass -= gone;
            balance_[a].extracted += gone;
        };
        const double mixed = -std::expm1(-opening.flow / volume() * dt);
        for (std::size_t a = 0; a < mixed_.size(); ++a) take(a, mixed_[a], mixed);
        for (Puff& puff : puffs_) {
            const Vec3 away = puff.place - opening.place;
            const double r = length(away), nearer = r * r * r - 3.0 * opening.flow * dt / (4.0 * std::numbers::pi);
            const double now = nearer > 0.0 ? std::cbrt(nearer) : 0.0;
            puff.place = r > 0.0 ? opening.place + now / r * away : opening.place;
            const double s = puff.radius, density = std::exp(-0.5 * now * now / (s * s)) /
                                                    (std::pow(2.0 * std::numbers::pi, 1.5) * s * s * s); // [1/m^3]
            for (std::size_t a = 0; a < puff.mass.size(); ++a)
                take(a, puff.mass[a], -std::expm1(-opening.flow * density * dt));
        }
    }
}

/// What was given off in a step of the heat; part of it has settled within the step.
void Smoke::add(const Fume& fume, Vec3 up, double gravity, double dt)
{
    const double vent = def_.inflow / volume();
    const std::array<double, 2> given{def_.yield * fume.taken, def_.steam * fume.boiled / kLatentHeat};
    std::array<double, 2> left{};
    for (std::size_t a = 0; a < given.size(); ++a) {
        const double settle = 1.0 / (a == 0 ? def_.settling : def_.drying), rate = vent + settle;
        left[a] = given[a] * shareLeft(rate, dt);
        balance_[a].emitted += given[a];
        if (!(rate > 0.0)) continue;
        balance_[a].vented += (given[a] - left[a]) * vent / rate;
        balance_[a].settled += (given[a] - left[a]) * settle / rate;
    }
    const Vec3 place = max(def_.room.low, min(def_.room.high, fume.place));
    const double buoyancy = gravity * def_.warmth * fume.taken / kGasHeat;
    const auto young = std::ranges::find_if(puffs_.rbegin(), puffs_.rend(), [&](const Puff& each) {
        return each.age < kJoin && length(each.place - place) < kJoinWithin;
    });
    if (young != puffs_.rend()) {
        const double had = young->mass[0] + young->mass[1], more = left[0] + left[1];
        if (had + more > 0.0) young->place = young->place + more / (had + more) * (place - young->place);
        for (std::size_t a = 0; a < left.size(); ++a) young->mass[a] += left[a];
        young->buoyancy += buoyancy;
        return;
    }
    // The draught acts across the way up only.
    Vec3 drift{draught(def_.seed, time_, 0), draught(def_.seed, time_, 1), draught(def_.seed, time_, 2)};
    drift = kMostDrift * (drift - dot(drift, up) * up);
    puffs_.push_back({.place = place,
                      .radius = def_.radius,
                      .buoyancy = buoyancy,
                      .mass = left,
                      .drift = drift,
                      .number = ++count_});
}

void Smoke::mixOld()
{
    const auto join = [this](const Puff& puff) {
        for (std::size_t a = 0; a < mixed_.size(); ++a) mixed_[a] += puff.mass[a];
    };
    std::erase_if(puffs_, [&](const Puff& puff) {
        const bool old = puff.age > kOld * def_.mixing || !(puff.mass[0] + puff.mass[1] > 0.0);
        if (old) join(puff);
        return old;
    });
    while (puffs_.size() > kMostPuffs) {
        join(puffs_.front());
        puffs_.erase(puffs_.begin());
    }
}

SmokeBalance Smoke::balance() const
{
    std::array<AerosolBalance, 2> now = balance_;
    for (std::size_t a = 0; a < now.size(); ++a) {
        now[a].inAir = mixed_[a];
        for (const Puff& puff : puffs_) now[a].inAir += puff.mass[a];
    }
    return {now[0], now[1]};
}

double Smoke::extinction(const Puff& puff) const
{
    return def_.extinction * puff.mass[0] + def_.steamExtinction * puff.mass[1];
}

double Smoke::middle(const Puff& puff) const
{
    return extinction(puff) / (2.0 * std::numbers::pi * puff.radius * puff.radius);
}

double Smoke::haze() const { return (def_.extinction * mixed_[0] + def_.steamExtinction * mixed_[1]) / volume(); }

double Smoke::opticalDepth(Vec3 from, Vec3 to) const
{
    double sum = 0.0;
    for (const Puff& puff : puffs_) sum += middle(puff) * gaussianColumn(puff.place, puff.radius, from, to);
    return sum + haze() * geometry::lengthWithin(def_.room, from, to);
}

} // namespace filasofia::surface
