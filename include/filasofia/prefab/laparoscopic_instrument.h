#pragma once

#include "filasofia/prefab/articulated_instrument.h"
#include "filasofia/prefab/trocar.h"

namespace filasofia::prefab {

/// A rigid instrument through a trocar.
struct LaparoscopicInstrumentDef {
    std::string name = "instrument"; ///< what errors and reports call it, and its body
    /// Its jaws and its shaft; the kinds for laparoscopy suit. Its name and pose must be left out: they are said here.
    ArticulatedInstrumentDef tool = {.kind = InstrumentKind::LaparoscopicGrasper};
    TrocarDef trocar = {};
    TrocarHandleDef hand = {};
    TrocarPose start = {.insertion = 0.1}; ///< within the trocar's limits
};
constexpr auto fields(const LaparoscopicInstrumentDef*)
{
    using T = LaparoscopicInstrumentDef;
    return describe("LaparoscopicInstrumentDef", field("name", &T::name, "what errors and reports call it"),
                    field("tool", &T::tool, "its jaws and its shaft"),
                    field("trocar", &T::trocar, "where it goes through the wall"),
                    field("hand", &T::hand, "how it is held"), field("start", &T::start, "its pose at the start"));
}

/// An ArticulatedInstrument whose shaft goes through a trocar. A hand outside holds its handle; the shaft passes
/// through the fulcrum, which the wall lets yield sideways. So the tip goes the other way than the hand, and a force on
/// the tip is felt at the handle by the law of the lever: times the length inside over the length outside.
///
/// The motion is quasi-static: the shaft has no mass of its own. Any thread may call; poses take effect at the end of
/// the next step.
class LaparoscopicInstrument {
public:
    /// Throws an Error if the Def is wrong. Construct it before a run and destroy it before the simulation.
    LaparoscopicInstrument(runtime::Simulation& simulation, const LaparoscopicInstrumentDef& def = {});
    ~LaparoscopicInstrument();
    LaparoscopicInstrument(const LaparoscopicInstrument&) = delete;
    LaparoscopicInstrument& operator=(const LaparoscopicInstrument&) = delete;

    [[nodiscard]] BodyId body() const;
    [[nodiscard]] const LaparoscopicInstrumentDef& def() const;
    [[nodiscard]] ArticulatedInstrument& tool();             ///< to open and close it; do not move() it
    [[nodiscard]] const ArticulatedInstrument& tool() const; ///< the same

    /// Where the hand wants it; it goes there at 0.25 m/s at most if the hand has a finite strength. Error outside the
    /// trocar's limits, and if a haptic device holds it.
    void move(const TrocarPose& pose);

    [[nodiscard]] TrocarReport report() const; ///< as the last step left it

    /// With TrocarHandleDef::haptic: the dynamic body for a HapticInterfaceDef, at the handle. Otherwise 0.
    [[nodiscard]] BodyId handle() const;

private:
    struct Impl;
    std::shared_ptr<Impl> impl_; // shared with the simulation's callbacks
};

} // namespace filasofia::prefab
