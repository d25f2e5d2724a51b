#pragma once

#include "filasofia/core/error.h"

#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

namespace filasofia::prefab {

inline constexpr double kHandFollow = 0.06;   ///< [s], time constant with which a hand follows its person
inline constexpr double kMaxHandSpeed = 0.25; ///< [m/s], largest speed of a hand that was held up

/// Throws an Error if a move has no duration.
template <class Move> void checkMoves(const std::vector<Move>& moves, std::string_view object)
{
    for (std::size_t i = 0; i < moves.size(); ++i)
        if (!(moves[i].seconds > 0.0)) fail(object, ": moves[", i, "].seconds must be > 0 s, got ", moves[i].seconds);
}

/// Plays moves one after the other. Hands have a function between(from, to, part).
template <class Move> class HandScript {
public:
    using Hand = decltype(Move::to);

    explicit HandScript(const Hand& start) : goal_(start) {}

    [[nodiscard]] bool empty() const { return moves_.empty(); }
    void play(std::vector<Move> moves, const Hand& from)
    {
        moves_ = std::move(moves);
        move_ = -1;
        goal_ = from;
    }
    /// Completes moves that end within the step from `before` [s] of length `dt` [s], begins the next ones, and returns
    /// where the hands shall be at its end.
    Hand follow(double before, double dt)
    {
        if (move_ < 0) next(before);
        while (current() != nullptr && before + dt >= start_ + current()->seconds) {
            goal_ = current()->to;
            if (current()->end) current()->end();
            next(start_ + current()->seconds);
        }
        if (current() == nullptr) return goal_;
        const double t = (before + dt - start_) / current()->seconds;
        return goal_ = between(from_, current()->to, t * t * (3.0 - 2.0 * t));
    }

private:
    [[nodiscard]] Move* current()
    {
        return move_ < std::ssize(moves_) ? &moves_[static_cast<std::size_t>(move_)] : nullptr;
    }
    void next(double time)
    {
        ++move_;
        while (current() != nullptr && current()->skip && current()->skip()) ++move_;
        start_ = time;
        from_ = goal_;
        if (current() == nullptr) return;
        if (current()->aim) current()->to = current()->aim();
        if (current()->begin) current()->begin();
    }

    std::vector<Move> moves_;
    std::ptrdiff_t move_ = -1; ///< index of the present move; -1: before the first
    double start_ = 0.0;       ///< [s], when it began
    Hand from_ = {};           ///< where it began
    Hand goal_;                ///< where the script wants the hands now, if nothing holds them up
};

} // namespace filasofia::prefab
