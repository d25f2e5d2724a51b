#pragma once

#include "filasofia/prefab/articulated_instrument.h"

namespace filasofia::prefab {

/// What a tube sucks and how it rinses.
struct SuctionIrrigatorDef {
    Vec3 tip = {0.0, 0.0, -30e-3}; ///< [m], its mouth, in the coordinates of the tool's element 0
    double reach = 5e-3;           ///< [m], > 0, how far from the mouth blood is sucked and washed away
    double suction = 2e-5;         ///< [m^3/s], >= 0, of blood, 1.2 litres a minute
    double extraction = 1.5e-4;    ///< [m^3/s], in [0, 1], of gas and the smoke in it, 9 litres a minute
    double irrigation = 1.5e-5;    ///< [m^3/s], >= 0, of liquid
    int source = 100;              ///< [-], in [0, 1000], number of its opening among those that extract smoke
};
constexpr auto fields(const SuctionIrrigatorDef*)
{
    using T = SuctionIrrigatorDef;
    return describe("SuctionIrrigatorDef", field("tip", &T::tip, "m", finite(), "its mouth, on the tool's element 0"),
                    field("reach", &T::reach, "m", positive(), "how far from the mouth it acts"),
                    field("suction", &T::suction, "m^3/s", nonNegative(), "of blood"),
                    field("extraction", &T::extraction, "m^3/s", closed(0, 1), "of gas, and the smoke in it"),
                    field("irrigation", &T::irrigation, "m^3/s", nonNegative(), "of liquid"),
                    field("source", &T::source, "-", closed(0, 1000), "number of its opening for smoke"));
}

/// A tube that sucks blood and smoke away and rinses with liquid, wherever it is moved. Closing the tool
/// (ArticulatedInstrument::close()) is its suction valve; rinse() is the other one. It acts on every body that bleeds,
/// on each with all of its flow, and on smoke if there is a room for it. The liquid itself is not seen; it leaves with
/// the blood that it takes along. What begins to bleed, and a reset of the simulation, are noticed within a second.
class SuctionIrrigator {
public:
    /// The tool is a rigid body of any kind, InstrumentKind::SuctionIrrigator for example; it must outlive this object.
    /// Throws an Error if the Def is wrong. Construct it before a run.
    SuctionIrrigator(runtime::Simulation& simulation, ArticulatedInstrument& tool, const SuctionIrrigatorDef& def = {});
    ~SuctionIrrigator();
    SuctionIrrigator(const SuctionIrrigator&) = delete;
    SuctionIrrigator& operator=(const SuctionIrrigator&) = delete;

    void rinse(bool on); ///< from the next step on; any thread
    [[nodiscard]] bool rinses() const;
    [[nodiscard]] bool sucks() const;       ///< whether its tool is closed, as of the last step
    [[nodiscard]] double irrigated() const; ///< [m^3], of liquid that has flowed, up to the last step

private:
    struct Impl;
    std::shared_ptr<Impl> impl_; // shared with the simulation's callbacks
};

} // namespace filasofia::prefab
