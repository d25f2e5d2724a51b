#include "filasofia/surface/distension.h"

#include "filasofia/core/hash.h"
#include "filasofia/surface/checked_room.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace filasofia::surface {
namespace {

constexpr double kViscosity = 1e-6; ///< [m^2/s], kinematic viscosity of water
constexpr double kGone = 0.01;      ///< [-], share of the mean new bubble below which one has dissolved

/// A number in [0, 1) that is the same for the same bubble and axis.
double chanceOf(std::uint32_t number, int axis)
{
    Hasher bits;
    bits.add(static_cast<std::uint64_t>(number));
    bits.add(static_cast<std::uint64_t>(axis));
    return static_cast<double>(bits.value() >> 11U) * 0x1p-53;
}

/// [-] The volume of a bubble over the mean of all.
double sizeOf(std::uint32_t number) { return 0.3 + 1.4 * chanceOf(number, 0); }

double ballOf(double radius) { return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius; }

/// The flows while no valve opens or closes: C dp/dt = Gi (P - p) - Go p - Gl (p - L) + b.
struct Regime {
    double in = 0.0, out = 0.0, leak = 0.0; ///< [m^3/(Pa s)], conductances
    double rest = 0.0;                      ///< [Pa], where the pressure goes; without conductance unused
    [[nodiscard]] double all() const { return in + out + leak; }
};

} // namespace

double radiusOf(const Bubble& bubble) { return std::cbrt(0.75 / std::numbers::pi * bubble.volume); }

double risingSpeed(double radius, double gravity)
{
    // Re (1 + 0.15 Re^0.687) = g d^3 / (18 nu^2): the left side grows faster than Re, so Newton's steps from above
    // converge; eight give all digits for every bubble that a cavity can hold.
    const double d = 2.0 * radius, asked = gravity * d * d * d / (18.0 * kViscosity * kViscosity);
    double reynolds = asked;
    for (int i = 0; i < 12; ++i) {
        const double drag = 0.15 * std::pow(reynolds, 0.687);
        reynolds -= (reynolds * (1.0 + drag) - asked) / (1.0 + 1.687 * drag);
    }
    return reynolds * kViscosity / d;
}

Distension::Distension(const DistensionDef& def, const std::string& object) : def_(def)
{
    validateWithRoom(def_, object, "what is seen of it fills it");
    if (def_.up && !(length(*def_.up) > 0.0)) fail(object, ": up must have a length > 0, got 0");
    balance_.atStart = balance_.volume = def_.volume;
}

void Distension::apply(const Distend& command)
{
    def_.pressure = command.pressure.value_or(def_.pressure);
    def_.inflow = command.inflow.value_or(def_.inflow);
    def_.outflow = command.outflow.value_or(def_.outflow);
}

void Distension::heat(Vec3 place, double energy)
{
    if (energy > 0.0) sources_.push_back({place, energy});
}

double Distension::haze() const { return def_.turbidity + def_.extinction * bloodShare(balance_); }

DistensionBalance Distension::balance() const
{
    DistensionBalance now = balance_;
    now.inflow = std::max(def_.pressure - now.pressure, 0.0) * def_.inflow / def_.inflowResistance;
    now.outflow = now.pressure * def_.outflow / def_.outflowResistance;
    now.gas = gas_;
    for (const Bubble& each : bubbles_) now.gas += each.volume;
    return now;
}

void Distension::step(Vec3 gravity, double dt)
{
    if (!(dt > 0.0)) return;
    const double welling = std::exchange(welling_, 0.0) / dt;
    for (double left = dt; left > 0.0;) left -= flow(left, welling);
    balance_.beyondLimit = balance_.beyondLimit || deficit(balance_) > def_.deficitLimit;
    const double pull = length(gravity);
    const Vec3 up = def_.up ? normalized(*def_.up) : pull > 0.0 ? -1.0 / pull * gravity : Vec3{};
    thinBubbles(dt);
    moveBubbles(up, dt);
    formBubbles();
    sources_.clear();
}

/// Flows for `dt` [s], or until a valve opens or closes; returns how long.
double Distension::flow(double dt, double welling)
{
    const double C = def_.compliance, P = def_.pressure, L = def_.leakPressure, p = balance_.pressure;
    const double Gi = def_.inflow / def_.inflowResistance, Go = def_.outflow / def_.outflowResistance,
                 Gl = 1.0 / def_.leakResistance;
    // At a valve's own pressure nothing flows through it, so the direction in which the pressure goes decides.
    const double rate = Gi * std::max(P - p, 0.0) - Go * p - Gl * std::max(p - L, 0.0) + welling;
    Regime now{p < P || (p == P && rate < 0.0) ? Gi : 0.0, Go, p > L || (p == L && rate > 0.0) ? Gl : 0.0};
    const double G = now.all();
    now.rest = G > 0.0 ? (now.in * P + now.leak * L + welling) / G : 0.0;
    // When the next valve moves: p(t) = rest + (p - rest) exp(-t G / C), or a straight line.
    double after = dt;
    std::optional<double> at;
    for (const double valve : {P, L}) {
        if (rate > 0.0 ? !(valve > p) : !(valve < p)) continue;
        const double past = (p - now.rest) / (valve - now.rest);
        const double when = G > 0.0 ? (past > 1.0 ? C / G * std::log(past) : -1.0) : C * (valve - p) / welling;
        if (when <= 0.0 || when >= after) continue;
        after = when;
        at = valve;
    }
    // The integral of the pressure, and the pressure at the end.
    const double fallen = -std::expm1(-after * G / C);
    const double sum =
        G > 0.0 ? now.rest * after + (p - now.rest) * C / G * fallen : p * after + 0.5 * welling / C * after * after;
    const double end = G > 0.0 ? p + (now.rest - p) * fallen : p + welling / C * after;
    const double in = now.in * (P * after - sum), out = now.out * sum, lost = now.leak * (sum - L * after);
    mix(after, welling, in, out + lost);
    balance_.in += in;
    balance_.bled += welling * after;
    balance_.out += out;
    balance_.lost += lost;
    balance_.volume = balance_.atStart + balance_.in + balance_.bled - balance_.out - balance_.lost;
    balance_.pressure = at ? *at : std::max(end, 0.0);
    return at ? after : dt;
}

/// Blood in a well-mixed volume: d(blood)/dt = welling - blood / volume * what flows away.
void Distension::mix(double dt, double welling, double in, double away)
{
    const double middle = balance_.volume + 0.5 * (in + welling * dt - away);
    const double x = away / middle;
    balance_.blood = balance_.blood * std::exp(-x) + welling * dt * (x > 1e-9 ? -std::expm1(-x) / x : 1.0);
}

/// Gas of each electrode becomes bubbles of different sizes at its tip. If there are too many, the two oldest join.
void Distension::formBubbles()
{
    const double mean = ballOf(def_.bubble);
    for (const Source& each : sources_) {
        const double gas = each.energy * def_.gas;
        balance_.gasFormed += gas;
        gas_ += gas;
        for (double next = sizeOf(count_) * mean; gas_ >= next; next = sizeOf(count_) * mean) {
            if (bubbles_.size() == kMostBubbles) {
                bubbles_[1].volume += bubbles_[0].volume;
                bubbles_.erase(bubbles_.begin());
            }
            gas_ -= next;
            const Vec3 aside{chanceOf(count_, 1) - 0.5, chanceOf(count_, 2) - 0.5, chanceOf(count_, 3) - 0.5};
            bubbles_.push_back({each.place + 2.0 * def_.bubble * aside, next, count_++});
        }
    }
}

/// They rise, slide up along the ellipsoid in the room, and push each other aside where they gather.
void Distension::moveBubbles(Vec3 up, double dt)
{
    constexpr double kEarth = 9.81; // [m/s^2]: `up` says where, also where tissue is made to float without gravity
    for (Bubble& each : bubbles_) {
        each.place += dt * risingSpeed(radiusOf(each), kEarth) * up;
        keepInside(each);
    }
    for (std::size_t i = 0; i < bubbles_.size(); ++i)
        for (std::size_t j = i + 1; j < bubbles_.size(); ++j) {
            const Vec3 apart = bubbles_[j].place - bubbles_[i].place;
            const double far = length(apart), overlap = radiusOf(bubbles_[i]) + radiusOf(bubbles_[j]) - far;
            if (overlap <= 0.0) continue;
            const Vec3 push = far > 1e-9 ? 0.5 * overlap / far * apart : Vec3{0.5 * overlap, 0.0, 0.0};
            bubbles_[i].place -= push;
            bubbles_[j].place += push;
        }
    for (Bubble& each : bubbles_) keepInside(each);
}

void Distension::keepInside(Bubble& bubble) const
{
    const Vec3 middle = 0.5 * (def_.room.low + def_.room.high), half = 0.5 * (def_.room.high - def_.room.low);
    const Vec3 from = bubble.place - middle;
    const double out = length(Vec3{from.x / half.x, from.y / half.y, from.z / half.z});
    if (out > 1.0) bubble.place = middle + 1.0 / out * from;
}

/// The outflow takes them as it takes the fluid, and they dissolve.
void Distension::thinBubbles(double dt)
{
    const double flow = balance_.pressure * def_.outflow / def_.outflowResistance;
    const double left = std::exp(-dt * (flow / balance_.volume + 1.0 / def_.bubbleLife));
    for (Bubble& each : bubbles_) each.volume *= left;
    std::erase_if(bubbles_, [&](const Bubble& each) { return each.volume < kGone * ballOf(def_.bubble); });
}

} // namespace filasofia::surface
