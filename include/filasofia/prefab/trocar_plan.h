#pragma once

#include "filasofia/prefab/trocar_hands.h"

#include <functional>
#include <memory>
#include <vector>

namespace filasofia::prefab {

/// The pose that brings a point of an instrument, on its axis, to a place; its jaws open across a direction, and `back`
/// [m] is left along the shaft. Brought inside the trocar's limits.
TrocarPose reach(const LaparoscopicInstrument& tool, Vec3 place, Vec3 point, Vec3 across, double back = 0.0);

/// Where one hand goes: asked when its move begins. Empty: it stays.
using TrocarAim = std::function<TrocarPose()>;

/// A planned motion of two hands, made move by move, for TrocarHands::play(). A hand that a move says nothing of stays
/// where the last one has brought it. Copies share goal(): only one of them can be played.
class TrocarPlan {
public:
    /// The hands begin where their instruments and the scope do. All must live as long as what is played.
    TrocarPlan(const LaparoscopicInstrument& left, const LaparoscopicInstrument& right, const Laparoscope& scope);

    /// Adds a move that lasts `seconds`, > 0; begin, end and skip of what it returns may be set until the next one.
    TrocarMove& add(double seconds, TrocarAim left, TrocarAim right);
    TrocarMove& rest(double seconds) { return add(seconds, {}, {}); }
    /// Where the hands were sent last, while it is played.
    [[nodiscard]] std::shared_ptr<const TrocarPoses> goal() const { return goal_; }
    [[nodiscard]] double seconds() const; ///< [s], all moves, also those that may be skipped
    [[nodiscard]] const std::vector<TrocarMove>& moves() const { return moves_; }

private:
    std::shared_ptr<TrocarPoses> goal_;
    std::array<TrocarDef, 2> trocars_;
    std::vector<TrocarMove> moves_;
};

} // namespace filasofia::prefab
