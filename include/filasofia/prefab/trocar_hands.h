#pragma once

#include "filasofia/prefab/hand_move.h"
#include "filasofia/prefab/laparoscope.h"
#include "filasofia/prefab/laparoscopic_instrument.h"

#include <functional>

/// Two hands of an operator and one of an assistant.
namespace filasofia::prefab {

/// Where the three hands are.
struct TrocarPoses {
    TrocarPose left = {}, right = {}, scope = {};
};
TrocarPoses between(const TrocarPoses& a, const TrocarPoses& b, double part);

/// One movement of a script, as HandMove.
struct TrocarMove {
    double seconds = 1.0; ///< [s], > 0
    TrocarPoses to = {};
    std::function<TrocarPoses()> aim = {}; ///< used in place of `to`, when the move begins
    std::function<bool()> skip = {};       ///< if it returns true, the move is left out
    std::function<void()> begin = {};
    std::function<void()> end = {};
};

struct TrocarHandsDef {
    double gain = 0.002; ///< [rad], in (0, 0.1], turn of a shaft per pixel of the mouse
    /// The haptic interfaces that hold the handles; their first buttons close and open the jaws. 0: none.
    runtime::HapticId leftDevice = {}, rightDevice = {};
};
constexpr auto fields(const TrocarHandsDef*)
{
    return describe("TrocarHandsDef",
                    field("gain", &TrocarHandsDef::gain, "rad", openClosed(0, 0.1), "turn per pixel of the mouse"));
}

/// Moves two instruments and a scope before every step, by a script or by a person; haptic devices move the handles of
/// those that have one (TrocarHandleDef::haptic).
///
/// A person chooses a hand with 1 (left), 2 (right) and 3 (scope), and then drags with the right button to turn its
/// shaft: the tip follows the mouse. The wheel, W and S move it in and out, A and D roll it, G closes and opens its
/// jaws; Page up and Page down zoom. The left button closes the jaws of the chosen hand while it is held down.
class TrocarHands {
public:
    /// Construct it before a run; Error if the Def is wrong. Instruments and scope must live as long.
    TrocarHands(runtime::Simulation& simulation, LaparoscopicInstrument& left, LaparoscopicInstrument& right,
                Laparoscope& scope, const TrocarHandsDef& def = {});
    ~TrocarHands();
    TrocarHands(const TrocarHands&) = delete;
    TrocarHands& operator=(const TrocarHands&) = delete;

    /// Plays a script from the next step on, in place of the person. What it wants beyond the trocars' limits is
    /// brought to them. Error if a move has no duration.
    void play(std::vector<TrocarMove> moves);
    [[nodiscard]] TrocarPoses wanted() const; ///< where the hands are told to be, in the last step

private:
    struct Impl;
    std::shared_ptr<Impl> impl_; // shared with the simulation's callbacks
};

} // namespace filasofia::prefab
