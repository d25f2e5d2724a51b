#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/prefab/articulated_instrument.h"

#include <memory>
#include <string>
#include <vector>

namespace filasofia::prefab {

/// A knot that a hand and a needle driver tie: one to three throws around the driver's shaft, each tightened before the
/// next.
struct InstrumentTieDef {
    std::string name = "instrument tie";
    BodyId thread = {}; ///< a rod that collides with itself
    /// [-], in [0, nodes of the rod): the one that the hand holds, and the one of the tail that the driver takes;
    /// empty: the rod's ends. Above the tissue the first strand needs about 100 mm, the tail 30 to 35 mm. The driver
    /// holds a tail better 3 mm before its end. A tail stands up, away from the other strand.
    std::vector<int> nodes = {};
    Vec3 place = {};               ///< [m], where the knot is to lie: on the tissue, above the middle of the wound
    Vec3 up = {0.0, 1.0, 0.0};     ///< [-], any length > 0, away from the tissue
    Vec3 across = {1.0, 0.0, 0.0}; ///< [-], any length > 0, across the wound: the throws are tightened along it
    /// [-], how often the thread goes around the shaft, for each throw: one to three entries, the first in [1, 2], the
    /// others 1.
    std::vector<int> turns = {2, 1};
    /// The driver. Its pose is where it waits, before the knot and after it. Its friction is that of thread on shaft.
    ArticulatedInstrumentDef driver = {.name = "needle driver",
                                       .kind = InstrumentKind::NeedleDriver,
                                       .pose = {{0.0, 0.15, 0.0}, {0.70710678118654752, -0.70710678118654752, 0, 0}},
                                       .friction = 0.03};
    double mouth = 10.5e-3;   ///< [m], > 0, from the driver's pivot to where its jaws hold
    double force = 1.0;       ///< [N], > 0, with which hand and driver each tighten a throw; neither draws harder
    double holding = 0.1;     ///< [N], > 0, with which they keep their strands taut meanwhile
    double speed = 0.2;       ///< [m/s], > 0, largest speed of hand and driver
    double stiffness = 300.0; ///< [N/m], > 0, of the hand's grip
    double patience = 1.0; ///< [s], > 0, longest time for which they wait until a strand rests, or is between the jaws
};
constexpr auto fields(const InstrumentTieDef*)
{
    using T = InstrumentTieDef;
    return describe(
        "InstrumentTieDef", field("name", &T::name, "what errors and reports call it"),
        field("thread", &T::thread, "a rod"),
        field("nodes", &T::nodes, "-", nonNegative(), "the one that the hand holds, that which the driver takes"),
        field("place", &T::place, "m", finite(), "where the knot is to lie"),
        field("up", &T::up, "-", finite(), "away from the tissue"),
        field("across", &T::across, "-", finite(), "across the wound: throws are tightened along it"),
        field("turns", &T::turns, "-", closed(1, 2), "turns around the shaft, of the throws"),
        field("driver", &T::driver, "the instrument around whose shaft the thread is wound"),
        field("mouth", &T::mouth, "m", positive(), "from the driver's pivot to where its jaws hold"),
        field("force", &T::force, "N", positive(), "with which hand and driver tighten a throw"),
        field("holding", &T::holding, "N", positive(), "with which they keep their strands taut"),
        field("speed", &T::speed, "m/s", positive(), "largest speed of hand and driver"),
        field("stiffness", &T::stiffness, "N/m", positive(), "of the hand's grip"),
        field("patience", &T::patience, "s", positive(), "longest time of waiting for a strand"));
}

/// A hand and a needle driver that tie a knot as surgeons do: the driver comes over the wound from the side of the long
/// strand, the hand winds that strand around its shaft, and an assistant brings the tail between its jaws. They draw it
/// back through the loops, which fingers hold meanwhile. Then both draw along `across`, each on the other side than
/// before. While the next throw is made, fingers pinch the strands where they leave the last one. The driver touches
/// the thread with contact and friction, and holds it between its jaws. Hand, assistant and fingers touch nothing.
///
/// Every function may be called from any thread and takes effect at the next step. A reset of the simulation does not
/// let go: call release() before. Throws of two turns, one and one are a surgeon's knot.
class InstrumentTie {
public:
    /// Adds the hand and the driver. Throws an Error if the Def is wrong. Construct it before a run and destroy it
    /// before the simulation.
    InstrumentTie(runtime::Simulation& simulation, const InstrumentTieDef& def);
    ~InstrumentTie();
    InstrumentTie(const InstrumentTie&) = delete;
    InstrumentTie& operator=(const InstrumentTie&) = delete;

    /// Takes the thread and ties all throws; then hand and assistant hold their strands, slack. Does nothing if it has
    /// begun.
    void begin();
    void release(); ///< lets the thread go; begin() starts anew

    [[nodiscard]] int tied() const;  ///< [-], throws that are tied and tightened
    [[nodiscard]] bool done() const; ///< whether all are
    /// Whether it has given up, since the tail was too short, did not come between the jaws, or not through the loops.
    /// The log says why, and at which throw.
    [[nodiscard]] bool failed() const;
    /// [N], largest force with which the hand has drawn at its strand since begin(), and the driver at the tail.
    [[nodiscard]] double largestForce() const;
    [[nodiscard]] BodyId hand() const; ///< the body that moves the first node
    [[nodiscard]] const ArticulatedInstrument& driver() const;

private:
    struct Impl;
    std::shared_ptr<Impl> impl_; // shared with the simulation's callback
};

} // namespace filasofia::prefab
