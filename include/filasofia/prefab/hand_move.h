#pragma once

#include <vector>

namespace filasofia::prefab {

/// [s], total duration of all moves of a script of any hands.
template <class Move> double durationOf(const std::vector<Move>& moves)
{
    double sum = 0.0;
    for (const Move& move : moves) sum += move.seconds;
    return sum;
}

} // namespace filasofia::prefab
