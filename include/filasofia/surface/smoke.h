#pragma once

#include "filasofia/surface/burning_def.h"
#include "filasofia/surface/smoke_def.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace filasofia::surface {

/// A cloud whose density falls with the distance as a Gaussian.
struct Puff {
    Vec3 place = {};              ///< [m], its middle, in the world
    double radius = 0.0;          ///< [m], its standard deviation
    double speed = 0.0;           ///< [m/s], upwards
    double buoyancy = 0.0;        ///< [m^4/s^2], weight that its warm gas lacks, over the density of the gas around it
    std::array<double, 2> mass{}; ///< [kg], smoke and droplets
    Vec3 drift = {};              ///< [-], way aside per way up
    double age = 0.0;             ///< [s]
    std::uint32_t number = 0;     ///< counts them
};

/// One step of `dt` [s] of a puff that rises in still gas by its buoyancy: a thermal (Morton, Taylor and Turner 1956),
/// solved exactly. Returns how far it rises [m]; its speed and radius change.
double rise(Puff& puff, double entrainment, double dt);

/// Smoke and steam in one room: puffs that rise and spread, and what has mixed with all the room. A plain value that a
/// copy saves; the same calls give the same bits. It knows no clock and no thread.
class Smoke {
public:
    /// Throws an Error that names `object` if the Def is wrong.
    Smoke(const SmokeDef& def, const std::string& object);

    /// Given off evenly over the next step.
    void emit(const Fume& fume);
    /// An opening at a place in the world takes so much gas [m^3/s] in the next step; none while it is outside the
    /// room.
    void extract(Vec3 place, double flow);
    /// `dt` [s], >= 0. Error-free; nothing happens in clear air.
    void step(Vec3 gravity, double dt);

    [[nodiscard]] SmokeBalance balance() const;
    [[nodiscard]] const std::vector<Puff>& puffs() const { return puffs_; }
    [[nodiscard]] double extinction(const Puff& puff) const; ///< [m^2], mass times extinction, of both aerosols
    [[nodiscard]] double middle(const Puff& puff) const;     ///< [-], optical depth of a line through its middle
    [[nodiscard]] double haze() const;                       ///< [1/m], what has mixed with all the room
    /// [-], along a straight way: exp(-depth) of the light passes.
    [[nodiscard]] double opticalDepth(Vec3 from, Vec3 to) const;
    [[nodiscard]] const SmokeDef& def() const { return def_; }

private:
    struct Opening {
        Vec3 place = {};
        double flow = 0.0;
    };
    void thin(double dt);
    void move(Vec3 up, double dt);
    void suck(double dt);
    void add(const Fume& fume, Vec3 up, double gravity, double dt);
    void mixOld();
    [[nodiscard]] double volume() const;

    SmokeDef def_;
    std::vector<Puff> puffs_;          ///< from the oldest to the newest
    std::array<double, 2> mixed_ = {}; ///< [kg], all over the room
    std::array<AerosolBalance, 2> balance_ = {};
    std::vector<Fume> fumes_;       ///< for the next step
    std::vector<Opening> openings_; ///< for the next step
    double time_ = 0.0;             ///< [s]
    std::uint32_t count_ = 0;       ///< puffs that there ever were
};

} // namespace filasofia::surface
