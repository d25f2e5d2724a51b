#pragma once

#include "filasofia/surface/film.h"

/// Kernels of heat in a thin layer on a surface of triangles.
namespace filasofia::surface {

constexpr double kLatentHeat = 2.257e6; ///< [J/kg], water at its boiling point takes it

/// d omega / dt [1/s] by Arrhenius' law, at a temperature [K].
double damageRate(double temperature, double frequencyFactor, double activationEnergy);
/// The damage [-] of `dt` [s] in which the temperature goes from `from` to `to` [K]: exact if the rate grows
/// exponentially.
double damageOver(double from, double to, double dt, double frequencyFactor, double activationEnergy);

/// Where a round source heats, and how much: shares that sum to 1, or none if it touches nothing.
struct HeatShare {
    int vertex = 0;     ///< by the numbers of the triangles
    double share = 0.0; ///< [-], in (0, 1]
};
/// What a source reaches: all within `radius` [m] of a point, of a line that may bend, or of a quadrilateral of two
/// triangles. Its points may coincide.
struct HeatReach {
    std::vector<Vec3> points = {Vec3{}}; ///< [m], in the world, at least one, in order along the line or around
    bool filled = false;                 ///< a quadrilateral, of four points
    double radius = 0.0;
};
/// Divides a source evenly over the surface within its reach, whatever the size of the triangles. Returns the area
/// reached [m^2]: 0 if it only grazes the surface, whose nearest point then takes all.
double divideSource(std::span<const geometry::Triangle> triangles, std::span<const Vec3> positions,
                    const HeatReach& reach, std::vector<HeatShare>& out);

/// Lets heat pass between neighbours for `dt` [s]. `warmth` [K] above rest and `capacity` [J/K] are per vertex,
/// `conductance` [W/K] per neighbour. Each pair exchanges by its exact law, forwards and then backwards, so heat is
/// conserved and no vertex becomes hotter than the hottest, whatever the step.
void conduct(const FilmTopology& topology, std::span<const double> conductance, std::span<const double> capacity,
             double dt, std::vector<double>& warmth);

/// What one vertex is made of, for a step.
struct HeatedVertex {
    double capacity = 0.0; ///< [J/K], > 0
    double loss = 0.0;     ///< [W/K], >= 0, to rest
    double latent = 0.0;   ///< [J], that its water takes until it has boiled away
    double boiling = 0.0;  ///< [K] above rest
    double limit = 0.0;    ///< [K] above rest; what is as hot takes no more power
};
struct HeatedStep {
    double warmth = 0.0;    ///< [K] above rest, at the end
    double delivered = 0.0; ///< [J]
    double lost = 0.0;      ///< [J]
    double boiled = 0.0;    ///< [J]
};
/// One vertex takes `power` [W] for `dt` [s], loses heat, and boils.
HeatedStep heatVertex(const HeatedVertex& vertex, double warmth, double power, double dt);

} // namespace filasofia::surface
