#include "apps/hysteroscopy/fluid.h"

using namespace filasofia;

namespace hysteroscopy {
namespace {

constexpr double kMmHg = 133.322; ///< [Pa]
constexpr double kTrickle = 0.25; ///< [-], how far the outflow is open if nobody opens it
constexpr double kStep = 10 * kMmHg, kMost = 150 * kMmHg;

/// 5 ml that become 15 under 75 mmHg. What is above the pressure in small vessels goes into them.
const DistensionDef kUterus{.room = {{-14_mm, 30_mm, -6_mm}, {14_mm, 66_mm, 6_mm}},
                            .outflow = kTrickle,
                            .leakPressure = 70 * kMmHg,
                            .leakResistance = 2e10,
                            .turbidity = 1.5,
                            .up = Vec3{0, 0, 1}};

/// Adds what the panel shows, before the panel.
Simulation& filled(Simulation& sim, const Bodies& bodies, double pressure, double flux)
{
    DistensionDef uterus = kUterus;
    uterus.pressure = pressure;
    sim.addDistension(uterus);
    sim.bleed(bodies.uterus, {.flux = 3e-4, .vesselDensity = std::numeric_limits<double>::infinity()});
    sim.bleed(bodies.polyp, {.flux = flux, .vesselDensity = std::numeric_limits<double>::infinity()});
    return sim;
}

} // namespace

Fluid::Fluid(Simulation& sim, const Bodies& bodies, double pressure, double flux)
    : sim_(sim), bodies_(bodies), pressure_(pressure), panel_(filled(sim, bodies, pressure, flux))
{
    sim.on<KeyEvent>([this](const KeyEvent& key) { press(key); });
}

void Fluid::press(const KeyEvent& key)
{
    if (!key.pressed) return;
    if (key.key == KeyCode::I && !key.repeat) sim_.distend({.inflow = (in_ = !in_) ? 1.0 : 0.0});
    if (key.key == KeyCode::O && !key.repeat) outflow(!out_);
    if (key.key == KeyCode::U || key.key == KeyCode::J) {
        pressure_ = std::clamp(pressure_ + (key.key == KeyCode::U ? kStep : -kStep), 0.0, kMost);
        sim_.distend({.pressure = pressure_});
    }
}

void Fluid::outflow(bool open)
{
    out_ = open;
    sim_.distend({.outflow = open ? 1.0 : kTrickle});
}

void Fluid::pierced(Vec3 place) { sim_.treat(bodies_.uterus, Injure{place, 5_mm}); }

double Fluid::bloodLost() const { return sim_.blood(bodies_.uterus).welled + sim_.blood(bodies_.polyp).welled; }

} // namespace hysteroscopy
