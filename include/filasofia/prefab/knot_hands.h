#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/runtime/simulation.h"

#include <memory>
#include <string>
#include <vector>

namespace filasofia::prefab {

/// A knot of throws that two hands tie with the ends of a thread, one after another, each tightened before the next.
struct KnotDef {
    std::string name = "knot";
    BodyId thread = {}; ///< a rod that collides with itself
    /// [-], in [0, nodes of the rod): the two that hands hold, that of the longer strand first; empty: the rod's ends.
    /// Above the tissue the first strand needs lengths for the loops, the second one for the way through them:
    /// with the values here, about 45 and 35 mm.
    std::vector<int> nodes = {};
    Vec3 place = {};               ///< [m], where the knot is to lie: on the tissue, above the middle of the wound
    Vec3 up = {0.0, 1.0, 0.0};     ///< [-], any length > 0, away from the tissue
    Vec3 across = {1.0, 0.0, 0.0}; ///< [-], any length > 0, across the wound: hands tighten along it
    /// [-], each in [1, 5]: of the throws. A surgeon's knot has 2, 1 and 1. Hands change sides with each throw, so each
    /// is the mirror image of that before: they make square knots.
    std::vector<int> turns = {2, 1, 1};
    double loop = 1.5e-3;     ///< [m], >= 2 radii of the thread, of the loops through which the second strand goes
    double height = 8e-3;     ///< [m], > loop, of the loops over the place
    double force = 1.0;       ///< [N], > 0, with which each hand tightens a throw
    double holding = 0.1;     ///< [N], > 0, with which each hand keeps its strand taut meanwhile
    double speed = 0.1;       ///< [m/s], > 0, largest speed of a hand
    double stiffness = 300.0; ///< [N/m], > 0, of a hand's grip, and of a finger's
    double patience = 1.0;    ///< [s], > 0, longest time for which hands wait until a strand rests
};
constexpr auto fields(const KnotDef*)
{
    using T = KnotDef;
    return describe(
        "KnotDef", field("name", &T::name, "what errors and reports call it"), field("thread", &T::thread, "a rod"),
        field("nodes", &T::nodes, "-", nonNegative(), "the two nodes that hands hold; empty: its ends"),
        field("place", &T::place, "m", finite(), "where the knot is to lie"),
        field("up", &T::up, "-", finite(), "away from the tissue"),
        field("across", &T::across, "-", finite(), "across the wound: hands tighten along it"),
        field("turns", &T::turns, "-", closed(1, 5), "turns of the throws"),
        field("loop", &T::loop, "m", positive(), "radius of the loops"),
        field("height", &T::height, "m", positive(), "height of the loops over the place"),
        field("force", &T::force, "N", positive(), "with which each hand tightens a throw"),
        field("holding", &T::holding, "N", positive(), "with which each hand keeps its strand taut"),
        field("speed", &T::speed, "m/s", positive(), "largest speed of a hand"),
        field("stiffness", &T::stiffness, "N/m", positive(), "of a hand's grip, and of a finger's"),
        field("patience", &T::patience, "s", positive(), "longest time for which hands wait until a strand rests"));
}

/// Two hands that tie a knot. The first strand is laid across the wound, and fingers form loops of it in the air; the
/// second hand goes through them with its end; the fingers let go, and both hands draw along `across`, each on the
/// other side than before. A throw slides down to the tissue while it is tightened, and draws a wound together.
///
/// Every function may be called from any thread and takes effect at the next step. A reset of the
/// simulation does not let go: call release() before.
class KnotHands {
public:
    /// Adds hands and fingers, which touch nothing. Throws an Error if the Def is wrong. Construct it before a run and
    /// destroy it before the simulation.
    KnotHands(runtime::Simulation& simulation, const KnotDef& def);
    ~KnotHands();
    KnotHands(const KnotHands&) = delete;
    KnotHands& operator=(const KnotHands&) = delete;

    void begin();   ///< takes the thread and ties all throws; then holds both strands up. Does nothing if it has begun
    void release(); ///< lets the thread go; begin() starts anew

    /// [-], throws that were tightened and made the thread the knot that they should.
    [[nodiscard]] int tied() const;
    [[nodiscard]] bool done() const; ///< whether all throws were made
    /// [N], largest force with which a hand has drawn at its strand since begin(), along it.
    [[nodiscard]] double largestForce() const;
    [[nodiscard]] BodyId hand(int which) const; ///< 0 or 1: the body that moves the first node, or the second one

private:
    struct Impl;
    std::shared_ptr<Impl> impl_; // shared with the simulation's callback
};

} // namespace filasofia::prefab
