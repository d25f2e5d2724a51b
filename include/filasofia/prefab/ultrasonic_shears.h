#pragma once

#include "filasofia/prefab/articulated_instrument.h"

namespace filasofia::prefab {

/// How shears heat, and when what they hold parts.
struct UltrasonicShearsDef {
    double power = 15.0;    ///< [W], in (0, 1e6], that tissue takes between pad and blade
    double limit = 373.15;  ///< [K], in (0, 1e7], no hotter: vibration coagulates, and chars little
    double radius = 1.5e-3; ///< [m], in (0, 1], how far from the lines of pad and blade tissue is heated
    double from = 1.5e-3;   ///< [m], >= 0, where the jaws begin to heat and to part, from the pivot
    double to = 14e-3;      ///< [m], > from, and where they end
    double height = 5e-3;   ///< [m], > 0, to each side of the blade's face that the parting reaches
    double sealed = 0.95;   ///< [-], in (0, 1], share of the heated nodes that are burnt when tissue parts
    double parting = 1.5;   ///< [s], > 0, in which it parts from the pivot to the tip
};
constexpr auto fields(const UltrasonicShearsDef*)
{
    using T = UltrasonicShearsDef;
    return describe("UltrasonicShearsDef",
                    field("power", &T::power, "W", openClosed(0, 1e6), "that tissue takes between pad and blade"),
                    field("limit", &T::limit, "K", openClosed(0, 1e7), "what is as hot takes no more"),
                    field("radius", &T::radius, "m", openClosed(0, 1), "how far from their lines tissue is heated"),
                    field("from", &T::from, "m", nonNegative(), "where the jaws begin to heat, from the pivot"),
                    field("to", &T::to, "m", positive(), "and where they end"),
                    field("height", &T::height, "m", positive(), "to each side that the parting reaches"),
                    field("sealed", &T::sealed, "-", openClosed(0, 1), "share that is burnt when tissue parts"),
                    field("parting", &T::parting, "s", positive(), "in which it parts from pivot to tip"));
}

/// Shears that seal and part what they hold (InstrumentKind::UltrasonicShears): the tool has a fixed blade, its element
/// 0, and a pad that presses on it, its element 1. While the pedal is pressed and tissue touches both, it takes
/// `power`. When enough of what is between them is burnt, it parts along the blade, sealed, from the pivot to the tip,
/// as long as the pedal stays pressed: once for each time that the jaws close. Power and times are chosen, not
/// measured.
///
/// What parts it is a thin blade of its own, which nobody sees, and which slides along the plane across pad and blade.
/// Tissue must burn (Simulation::burn()) and change its topology. Its mesh needs edges of at most `radius`: heat is
/// stored at nodes.
class UltrasonicShears {
public:
    static constexpr int kPedal = 0; ///< electrode of the tool that the pedal activates

    /// The tool must outlive this object, and have no electrode. Throws an Error if the Def or the tool is wrong.
    /// Construct it before a run.
    UltrasonicShears(runtime::Simulation& simulation, ArticulatedInstrument& tool, const UltrasonicShearsDef& def = {});
    ~UltrasonicShears();
    UltrasonicShears(const UltrasonicShears&) = delete;
    UltrasonicShears& operator=(const UltrasonicShears&) = delete;

    void press(bool on); ///< the pedal; the same as Simulation::activate() of the tool. Any thread
    /// [-], share of the heated nodes between the jaws that are burnt, as of the last step in which the pedal was
    /// pressed; 0 if there is none.
    [[nodiscard]] double sealed() const;
    [[nodiscard]] bool parts() const; ///< whether tissue is parting now
    [[nodiscard]] int parted() const; ///< [-], how often it has parted up to the tip

private:
    struct Impl;
    std::shared_ptr<Impl> impl_; // shared with the simulation's callbacks
};

} // namespace filasofia::prefab
