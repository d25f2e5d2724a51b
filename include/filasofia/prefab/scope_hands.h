#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/prefab/articulated_instrument.h"
#include "filasofia/prefab/endoscope.h"

#include <functional>
#include <limits>
#include <memory>
#include <vector>

/// Two hands: one moves an endoscope, the other an instrument in its channel.
namespace filasofia::prefab {

/// Where they are. The axis of the shaft always goes through one place, the fulcrum, which the body holds.
struct ScopeHand {
    Vec3 aim = {0.0, 0.0, -1.0}; ///< the shaft's direction, of any length > 0
    double depth = 0.0;          ///< [m], of the tip beyond the fulcrum
    double roll = 0.0;           ///< [rad], of the scope
    double reach = 0.0;          ///< [m], of the instrument's pivot out of the channel
};
constexpr auto fields(const ScopeHand*)
{
    using T = ScopeHand;
    return describe("ScopeHand", field("aim", &T::aim, "-", finite(), "direction of the shaft"),
                    field("depth", &T::depth, "m", finite(), "of the tip beyond the fulcrum"),
                    field("roll", &T::roll, "rad", finite(), "of the scope"),
                    field("reach", &T::reach, "m", finite(), "of the instrument out of the channel"));
}

struct ScopeHandsDef {
    Vec3 fulcrum = {};         ///< [m]
    Vec3 up = {0.0, 1.0, 0.0}; ///< [-], in the world: the upper side of the picture where nothing is rolled
    ScopeHand start = {};
    double leastDepth = -0.1;  ///< [m], of a person's hand
    double mostDepth = 0.1;    ///< [m], >= leastDepth
    double leastReach = -0.01; ///< [m]
    double mostReach = 0.03;   ///< [m], >= leastReach
    double mostTurn = 0.6;     ///< [rad], in (0, 1.5], of the shaft against where it starts
    double strength =
        std::numeric_limits<double>::infinity(); ///< [N], > 0: against more the hands neither push nor pull on
    bool handle = false;                         ///< held by a haptic device: see ScopeHands::handle()
};
constexpr auto fields(const ScopeHandsDef*)
{
    using T = ScopeHandsDef;
    return describe("ScopeHandsDef", field("fulcrum", &T::fulcrum, "m", finite(), "the shaft goes through it"),
                    field("up", &T::up, "-", finite(), "of the picture"), field("start", &T::start, "of the hands"),
                    field("leastDepth", &T::leastDepth, "m", finite(), "of a person's hand"),
                    field("mostDepth", &T::mostDepth, "m", finite(), "of a person's hand"),
                    field("leastReach", &T::leastReach, "m", finite(), "of a person's hand"),
                    field("mostReach", &T::mostReach, "m", finite(), "of a person's hand"),
                    field("mostTurn", &T::mostTurn, "rad", openClosed(0, 1.5), "against where it starts"),
                    field("strength", &T::strength, "N", positiveOrInfinite(), "against more they go no further"),
                    field("handle", &T::handle, "held by a haptic device"));
}

/// One movement of a script; it starts and ends at rest.
struct HandMove {
    double seconds = 1.0; ///< [s], > 0
    ScopeHand to = {};
    /// In place of `to`: asked for as it begins, on the stepping thread, as all here: for who looks before moving.
    std::function<ScopeHand()> aim = {};
    std::function<bool()> skip = {};  ///< asked before that: true leaves it out, with all that follows here
    std::function<void()> begin = {}; ///< as it begins: opens jaws
    std::function<void()> end = {};   ///< when it has been made
};

/// Moves an endoscope and an instrument before every step: by a script, or by a person's mouse and keys. With the right
/// button dragged the shaft turns, the wheel and the up and down keys move it in and out, left and right roll it; W and
/// S move the instrument, G closes and opens it. Or by a haptic device that holds the handle: its first button opens
/// and closes the jaws; while the second is held, in and out move the instrument in place of the scope.
class ScopeHands {
public:
    /// Before a run; Error where the Def is wrong. Scope and instrument are to live as long.
    ScopeHands(runtime::Simulation& simulation, Endoscope& scope, ArticulatedInstrument& instrument,
               const ScopeHandsDef& def = {});
    ~ScopeHands();
    ScopeHands(const ScopeHands&) = delete;
    ScopeHands& operator=(const ScopeHands&) = delete;

    /// The hands that have the instrument's pivot `shortOf` before a target [m], coming from the fulcrum.
    [[nodiscard]] ScopeHand at(Vec3 target, double shortOf, double roll, double reach) const;
    /// The roll in [-90, 90] degrees by which the instrument's jaws, which open up and down in the picture, open across
    /// `stalk` at the target; 0 where it points along the view.
    [[nodiscard]] double rollAcross(Vec3 stalk, Vec3 target) const;
    /// Where the scope's tip is then, with its roll.
    [[nodiscard]] Pose tip(const ScopeHand& hand) const;

    /// With ScopeHandsDef::handle: the body for a HapticInterfaceDef, the scope's outer end, 0.2 m from the fulcrum. It
    /// moves scope and instrument as a lever about the fulcrum does, and feels what they are pushed by. Else none.
    [[nodiscard]] BodyId handle() const;

    /// From the next step on, in place of the person. Error where a move lasts no time.
    void play(std::vector<HandMove> moves);

private:
    struct Impl;
    std::shared_ptr<Impl> impl_; // the simulation's callbacks have it too
};

/// [s], of all of them.
double durationOf(const std::vector<HandMove>& moves);

} // namespace filasofia::prefab
