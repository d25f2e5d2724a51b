#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/prefab/articulated_instrument.h"
#include "filasofia/prefab/endoscope.h"
#include "filasofia/prefab/hand_move.h"
#include "filasofia/prefab/wire_loop.h"

#include <functional>

#include <limits>
#include <memory>
#include <vector>

/// Two hands: one moves an endoscope, the other an instrument in its channel.
namespace filasofia::prefab {

/// The pose of the hands. The axis of the shaft always passes through one point, the fulcrum, where the body holds it.
struct ScopeHand {
    Vec3 aim = {0.0, 0.0, -1.0}; ///< direction of the shaft, any length > 0
    double depth = 0.0;          ///< [m], distance of the tip beyond the fulcrum
    double roll = 0.0;           ///< [rad], roll of the scope
    double reach = 0.0;          ///< [m], distance of the instrument's pivot from the channel's mouth
};
constexpr auto fields(const ScopeHand*)
{
    using T = ScopeHand;
    return describe("ScopeHand", field("aim", &T::aim, "-", finite(), "direction of the shaft"),
                    field("depth", &T::depth, "m", finite(), "distance of the tip beyond the fulcrum"),
                    field("roll", &T::roll, "rad", finite(), "roll of the scope"),
                    field("reach", &T::reach, "m", finite(), "distance of the instrument from the channel"));
}

struct ScopeHandsDef {
    Vec3 fulcrum = {};         ///< [m]
    Vec3 up = {0.0, 1.0, 0.0}; ///< [-], in the world: the upper side of the picture if nothing is rolled
    ScopeHand start = {};
    double leastDepth = -0.1;  ///< [m], lower limit for a person's hand
    double mostDepth = 0.1;    ///< [m], >= leastDepth, upper limit
    double leastReach = -0.01; ///< [m], lower limit for a person's hand
    double mostReach = 0.03;   ///< [m], >= leastReach, upper limit
    double mostTurn = 0.6;     ///< [rad], in (0, 1.5], largest angle between the shaft and its start
    /// [N], > 0, the hands do not push or pull against a larger force.
    double strength = std::numeric_limits<double>::infinity();
    bool handle = false; ///< a haptic device holds the handle: see ScopeHands::handle()
};
constexpr auto fields(const ScopeHandsDef*)
{
    using T = ScopeHandsDef;
    return describe(
        "ScopeHandsDef", field("fulcrum", &T::fulcrum, "m", finite(), "the shaft goes through it"),
        field("up", &T::up, "-", finite(), "upper side of the picture"),
        field("start", &T::start, "initial pose of the hands"),
        field("leastDepth", &T::leastDepth, "m", finite(), "lower limit for a person"),
        field("mostDepth", &T::mostDepth, "m", finite(), "upper limit for a person"),
        field("leastReach", &T::leastReach, "m", finite(), "lower limit for a person"),
        field("mostReach", &T::mostReach, "m", finite(), "upper limit for a person"),
        field("mostTurn", &T::mostTurn, "rad", openClosed(0, 1.5), "largest angle from the start"),
        field("strength", &T::strength, "N", positiveOrInfinite(), "the hands do not move against a larger force"),
        field("handle", &T::handle, "whether a haptic device holds the handle"));
}

/// One movement of a script; it starts and ends at rest.
struct HandMove {
    double seconds = 1.0; ///< [s], > 0
    ScopeHand to = {};
    /// Used in place of `to`: returns the goal when the move begins, for a script that looks before it moves. Called on
    /// the stepping thread, like all functions here.
    std::function<ScopeHand()> aim = {};
    /// Called before that; if it returns true, the move is left out with its functions below.
    std::function<bool()> skip = {};
    std::function<void()> begin = {}; ///< called when the move begins, for example to open jaws
    std::function<void()> end = {};   ///< called when the move is complete
};

/// Moves an endoscope and an instrument before every step, by a script, by a person or by a haptic device. A person
/// drags with the right button to rotate the shaft; the wheel and the up and down keys move it in and out, left and
/// right roll it; W and S move the instrument, G closes and opens it. A loop cuts while G is pressed, and coagulates
/// while B is. A haptic device holds the handle: its first button does what G does; while the second is pressed, in and
/// out move the instrument instead of the scope.
class ScopeHands {
public:
    /// Construct it before a run; Error if the Def is wrong. Scope and instrument must live as long.
    ScopeHands(runtime::Simulation& simulation, Endoscope& scope, ArticulatedInstrument& instrument,
               const ScopeHandsDef& def = {});
    /// The same with a loop, whose pivot is the middle between the ends of its arms: `reach` is that of its working
    /// element.
    ScopeHands(runtime::Simulation& simulation, Endoscope& scope, WireLoop& loop, const ScopeHandsDef& def = {});
    ~ScopeHands();
    ScopeHands(const ScopeHands&) = delete;
    ScopeHands& operator=(const ScopeHands&) = delete;

    /// The hands that place the instrument's pivot `shortOf` [m] before a target, seen from the fulcrum.
    [[nodiscard]] ScopeHand at(Vec3 target, double shortOf, double roll, double reach) const;
    /// The roll in [-90, 90] degrees at which the instrument's jaws, which open up and down in the picture, open across
    /// `stalk` at the target; 0 if the stalk points along the view.
    [[nodiscard]] double rollAcross(Vec3 stalk, Vec3 target) const;
    /// The scope's tip for these hands, with its roll.
    [[nodiscard]] Pose tip(const ScopeHand& hand) const;

    /// With ScopeHandsDef::handle: the body for a HapticInterfaceDef, the scope's outer end, 0.2 m from the fulcrum. It
    /// moves scope and instrument like a lever about the fulcrum, and feels the forces on them. Otherwise 0.
    [[nodiscard]] BodyId handle() const;

    /// Plays a script from the next step on, in place of the person. Error if a move has no duration.
    void play(std::vector<HandMove> moves);

private:
    struct Impl;
    std::shared_ptr<Impl> impl_; // shared with the simulation's callbacks
};

} // namespace filasofia::prefab
