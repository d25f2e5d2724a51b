#include "filasofia/testing/knot_lines.h"

#include <cmath>
#include <numbers>

namespace filasofia::testing {
namespace {

constexpr int kPerTurn = 48; ///< points of a whole turn
constexpr double kWholeTurn = 2.0 * std::numbers::pi;

} // namespace

std::vector<Vec3> overhandKnot(const OverhandKnotDef& def)
{
    const double a = 0.5 * def.clearance, half = 0.5 * def.turns * def.pitch;
    const int points = def.turns * kPerTurn;
    std::vector<Vec3> line{{a, 0, -half - def.tail}};
    for (int i = 0; i <= points; ++i) {
        const double share = static_cast<double>(i) / points, angle = kWholeTurn * def.turns * share;
        line.push_back({a * std::cos(angle), a * std::sin(angle), half * (2.0 * share - 1.0)});
    }
    // The loop: half a circle, back beside the turns, half a circle; it goes over from +a to -a meanwhile.
    const auto beside = [&](double share) { return a * std::cos(0.5 * kWholeTurn * share); };
    for (int i = 1; i <= kPerTurn / 2; ++i) {
        const double share = 2.0 * static_cast<double>(i) / kPerTurn, angle = 0.5 * kWholeTurn * share;
        line.push_back({beside(share / 3.0), def.loop * (1.0 - std::cos(angle)), half + def.loop * std::sin(angle)});
    }
    for (int i = 1; i < kPerTurn / 2; ++i) {
        const double share = 2.0 * static_cast<double>(i) / kPerTurn;
        line.push_back({beside((1.0 + share) / 3.0), 2.0 * def.loop, half * (1.0 - 2.0 * share)});
    }
    for (int i = 0; i < kPerTurn / 2; ++i) {
        const double share = 2.0 * static_cast<double>(i) / kPerTurn, angle = 0.5 * kWholeTurn * share;
        line.push_back(
            {beside((2.0 + share) / 3.0), def.loop * (1.0 + std::cos(angle)), -half - def.loop * std::sin(angle)});
    }
    for (int i = 0; i <= points; ++i) {
        const double share = static_cast<double>(i) / points, angle = kWholeTurn * def.turns * share;
        line.push_back({-a * std::cos(angle), -a * std::sin(angle), half * (2.0 * share - 1.0)});
    }
    line.push_back({-a, 0, half + def.tail});
    return line;
}

std::vector<Vec3> throwsLine(const ThrowsDef& def)
{
    const double a = 0.5 * def.clearance, half = 0.5 * def.length;
    std::vector<Vec3> line{{-half - def.standing, 0, a}};
    double along = 1.0; // the direction of the throw
    for (std::size_t k = 0; k < def.turns.size(); ++k) {
        const double y = def.rise * static_cast<double>(k), turns = def.turns[k];
        const int points = def.turns[k] * kPerTurn;
        // Both threads leave a throw as they have entered it, this one before the other one. So every throw adds
        // crossings if it turns to the left along x, and the next to the right.
        const double winding = k % 2 == 0 ? -1.0 : 1.0;
        for (int i = 0; i <= points; ++i) {
            const double share = static_cast<double>(i) / points;
            const double x = along * half * (2.0 * share - 1.0);
            const double angle = winding * kWholeTurn * turns * (x + half) / def.length;
            line.push_back({x, y - a * std::sin(angle), a * std::cos(angle)});
        }
        if (k + 1 < def.turns.size())
            for (int i = 1; i < kPerTurn / 2; ++i) {
                const double angle = kWholeTurn * i / kPerTurn;
                line.push_back({along * (half + 0.5 * def.rise * std::sin(angle)),
                                y + 0.5 * def.rise * (1.0 - std::cos(angle)), a});
            }
        along = -along;
    }
    line.push_back({-along * (half + def.tail), line.back().y, a});
    return line;
}

Vec3 halfTurn(Vec3 p) { return {-p.x, p.y, -p.z}; }

} // namespace filasofia::testing
