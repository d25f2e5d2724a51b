#pragma once

#include "filasofia/geometry/triangle_mesh.h"
#include "filasofia/physics/cavity_def.h"

#include <array>
#include <span>
#include <string>
#include <vector>

namespace filasofia::engine {

struct SoftModel;
struct BodyTopology;

/// The edge of a wall where it has been opened, as directed edges like those of the wall's triangles there.
struct CavityRim {
    std::vector<std::array<int, 2>> edges;
};

/// A space that the surface of a body encloses.
struct Cavity {
    physics::CavityDef def;
    /// Nodes of the wall, counter-clockwise seen from the tissue: the normals point out of the cavity.
    std::vector<geometry::Triangle> wall;
    std::vector<CavityRim> rims; ///< none: it is closed, or all of the wall is gone
    double restVolume = 0.0;     ///< [m^3] at the start
    [[nodiscard]] bool isOpen() const { return !rims.empty() || wall.empty(); }
};

/// What fills a cavity.
struct CavityState {
    /// Gas: absolute pressure times volume [J]. Liquid: its volume at the outer pressure [m^3]. Source: unused
    double content = 0.0;
    double pressure = 0.0;    ///< [Pa] for a Source
    double inflow = 0.0;      ///< [m^3/s] see SetCavity
    double conductance = 0.0; ///< [m^3/(s Pa)] of its openings in the present step: outflow per pressure
    double last = 0.0;        ///< [Pa] the pressure at the end of the last step
    bool warned = false;      ///< the log has said that it is empty, or bursting
    double lost = 0.0;        ///< [m^3] see frame::Cavity
};

/// The pressure in a cavity at the end of a step, if its volume does not change, and how it answers to that. What flows
/// out through openings in the step lowers both: with the fall k of the pressure per volume and the conductance c, p by
/// 1 + h k c. Suction ends with the volume: it fades over the last part of it.
struct CavityPressure {
    double pressure = 0.0;  ///< [Pa] above that outside
    double stiffness = 0.0; ///< [Pa/m^3], >= 0: its fall per increase of the volume; 0 if it is as good as flat
};
CavityPressure pressureIn(const Cavity& cavity, const CavityState& state, double volume, double dt);
/// The content at which a cavity of this volume has this pressure.
double contentAt(const Cavity& cavity, double pressure, double volume);

/// [m^2] The area of a triangle, along its normal.
Vec3 areaOf(const geometry::Triangle& t, std::span<const Vec3> x);
/// [m] The mean of its nodes.
Vec3 middleOf(const CavityRim& rim, std::span<const Vec3> x);
/// [m^3] Up to a flat lid on each rim: the triangles of its edges with their middle.
double volumeOf(const Cavity& cavity, std::span<const Vec3> x);
/// [m^2] The sum over its rims: each as large as its lid is as a vector. Two rims that face each other, as those of a
/// cavity that was cut right through, open only as far as they are apart.
double openingOf(const Cavity& cavity, std::span<const Vec3> x);
[[nodiscard]] double densityOf(const Cavity& cavity);

/// Finds the cavities of a body in its surface. Throws an Error that begins with `object` if there is none for a Def.
void addCavities(const std::vector<physics::CavityDef>& defs, const std::string& object, SoftModel& model);
/// The states at the start, at the model's positions at rest.
std::vector<CavityState> cavitiesAtRest(const SoftModel& model);
/// Finds walls and rims again after the surface has changed; returns the cavities that were closed and are open now.
std::vector<int> followCavities(const BodyTopology& topology, SoftModel& model);

} // namespace filasofia::engine
