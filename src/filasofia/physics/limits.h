#pragma once

/// Where all engines draw the line between what moves and what jumped or is lost.
namespace filasofia::physics {

// A kinematic body that would have to move or turn faster jumps: it has no velocity, and its blades have no path.
inline constexpr double kTeleport = 20.0;    ///< [m/s]
inline constexpr double kTeleportTurn = 1.0; ///< [rad] in one step

inline constexpr double kLostDistance = 10.0; ///< [m] from where it began: a piece has fallen out of the scene

} // namespace filasofia::physics
