#pragma once

#include "verification/verification.h"

#include <numbers>

namespace filasofia::engine {

constexpr double kPi = std::numbers::pi;

inline double areaOf(const physics::RodBodyDef& def) { return kPi * def.radius * def.radius; }
inline double bendOf(const physics::RodBodyDef& def)
{
    return def.youngModulus * areaOf(def) * def.radius * def.radius / 4.0;
}
inline double twistOf(const physics::RodBodyDef& def) { return bendOf(def) / (1.0 + def.poissonRatio); }

/// A rod of this length along x from the origin, with an edge before it that clamps it.
inline physics::RodBodyDef clampedRod(double length, int edges)
{
    const double l = length / edges;
    return {.points = {{-l, 0, 0}, {length, 0, 0}},
            .spacing = l,
            .radius = 1e-3,
            .youngModulus = 1e8,
            .poissonRatio = 0.4,
            .rayleigh = {0.0, 0.0},
            .gravity = false,
            .attachments = {{.nodes = {0, 1}}}};
}

/// The same along an arc, at rest as it lies: its nodes are on the circle around (0, radius, 0), from the origin on.
inline physics::RodBodyDef clampedArc(double radius, double angle, int edges)
{
    physics::RodBodyDef def = clampedRod(radius, edges);
    def.straight = false;
    def.spacing = {};
    def.points.clear();
    const double step = angle / edges;
    for (int i = -1; i <= edges; ++i)
        def.points.push_back({radius * std::sin(i * step), radius * (1.0 - std::cos(i * step)), 0});
    return def;
}

/// Steps that are so long that nothing swings, until nothing moves.
inline void settle(Stage& stage, double dt, int steps) { stage.run(steps, dt); }

} // namespace filasofia::engine
