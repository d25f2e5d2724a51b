#include "filasofia/prefab/knot_plan.h"

#include <cmath>
#include <numbers>

namespace filasofia::prefab {
namespace {

constexpr double kAngle = 2.0 * std::numbers::pi / kFingersPerTurn; ///< [rad] from finger to finger

double chord(const KnotFrame& frame, double part) { return 2.0 * part * frame.loop * std::sin(0.5 * kAngle); }

} // namespace

double fingerStep(const KnotFrame& frame) { return std::hypot(chord(frame, 1.0), frame.pitch / kFingersPerTurn); }

std::vector<Vec3> loopsOf(const KnotFrame& frame, const Throw& made, double part)
{
    const double step = fingerStep(frame), across = chord(frame, part);
    const double along = std::sqrt(step * step - across * across);
    const double begin = 0.5 * made.turns * frame.pitch;
    std::vector<Vec3> fingers;
    for (int i = 0; i <= made.turns * kFingersPerTurn; ++i) {
        // The strand comes from below, goes up behind, and leaves below.
        const double angle = -kAngle * i - 0.5 * std::numbers::pi;
        const double radius = part * frame.loop;
        fingers.push_back(frame.at(made.side * (begin - along * i), frame.height + radius * std::sin(angle),
                                   radius * std::cos(angle)));
    }
    return fingers;
}

std::vector<Vec3> wayThrough(const KnotFrame& frame, const Throw& made)
{
    const double half = 0.5 * made.turns * frame.pitch, loop = frame.loop, y = frame.height, from = -made.side;
    return {frame.at(from * (half + 8.0 * loop), y, 6.0 * loop), frame.at(from * (half + 4.0 * loop), y, 2.0 * loop),
            frame.at(from * (half + 1.5 * loop), y, 0.0), frame.at(-from * (half + 2.0 * loop), y, 0.0),
            frame.at(-from * (half + 6.0 * loop), y, 2.0 * loop)};
}

} // namespace filasofia::prefab
