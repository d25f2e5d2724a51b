#pragma once

#include "filasofia/surface/distension_def.h"

#include <cstdint>
#include <string>
#include <vector>

namespace filasofia::surface {

/// Gas in the fluid.
struct Bubble {
    Vec3 place = {};          ///< [m], its middle, in the world
    double volume = 0.0;      ///< [m^3]
    std::uint32_t number = 0; ///< counts them
};
double radiusOf(const Bubble& bubble); ///< [m]

/// [m/s] How fast a bubble of this radius [m] rises in water under this gravity [m/s^2], once it is at its pace: as a
/// rigid sphere, which small bubbles are in water that is not clean (Schiller and Naumann 1933).
double risingSpeed(double radius, double gravity);

/// The fluid in one distended cavity: an elastic volume between a source of pressure, a tap and a leak, well mixed. A
/// plain value that a copy saves; the same calls give the same bits. It knows no clock and no thread.
class Distension {
public:
    /// Throws an Error that names `object` if the Def is wrong.
    Distension(const DistensionDef& def, const std::string& object);

    /// From the next step on. It must be valid.
    void apply(const Distend& command);
    /// [m^3], >= 0, wells evenly over the next step.
    void bleed(double volume) { welling_ += volume; }
    /// An electrode gives this energy [J], >= 0, at a place in the world in the next step.
    void heat(Vec3 place, double energy);
    /// `dt` [s], >= 0. Pressure and volumes are exact for a step of any length; what mixes, for as long as the volume
    /// changes little in it. Error-free.
    void step(Vec3 gravity, double dt);

    [[nodiscard]] DistensionBalance balance() const;
    [[nodiscard]] const std::vector<Bubble>& bubbles() const { return bubbles_; } ///< at most kMostBubbles
    [[nodiscard]] double haze() const; ///< [1/m], extinction of the fluid now
    [[nodiscard]] const DistensionDef& def() const { return def_; }
    static constexpr std::size_t kMostBubbles = 48;

private:
    struct Source {
        Vec3 place = {};
        double energy = 0.0;
    };
    double flow(double dt, double welling);
    void mix(double dt, double welling, double in, double away);
    void formBubbles();
    void moveBubbles(Vec3 up, double dt);
    void keepInside(Bubble& bubble) const;
    void thinBubbles(double dt);

    DistensionDef def_; ///< with the present settings of pump and taps
    DistensionBalance balance_ = {};
    double welling_ = 0.0; ///< [m^3], in the next step
    std::vector<Source> sources_;
    std::vector<Bubble> bubbles_; ///< from the oldest to the newest
    double gas_ = 0.0;            ///< [m^3], that has not become a bubble yet
    std::uint32_t count_ = 0;     ///< bubbles that there ever were
};

} // namespace filasofia::surface
