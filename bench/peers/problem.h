#pragma once

#include "filasofia/geometry/tet_mesh.h"

#include <memory>
#include <vector>

/// A program that compares other engines with ours. It is not part of the library.
namespace filasofia::peers {

/// The bunny pinned at its head and hanging: the problem given to both engines.
struct Problem {
    std::shared_ptr<const geometry::TetMesh> mesh = {};
    std::vector<int> pinned = {}; ///< nodes that do not move
    double dt = 5e-3;             ///< [s]
    int steps = 200;
    double rayleighMass = 0.1;       ///< [1/s]
    double rayleighStiffness = 0.01; ///< [s]
};

inline constexpr double kDensity = 1000.0;    ///< [kg/m^3]
inline constexpr double kYoungModulus = 10e3; ///< [Pa]
inline constexpr double kPoissonRatio = 0.45; ///< [-]
inline constexpr double kGravity = 9.81;      ///< [m/s^2], along -y
inline constexpr double kPinnedAbove = 0.105; ///< [m] height above which the bunny is pinned; the bunny is 0.15 m high
/// Numbers of tetrahedra of the available meshes.
inline const std::vector<int> kSizes = {756, 1492, 3004, 10000, 30000};

/// One engine's run.
struct Run {
    std::vector<double> seconds = {}; ///< [s] wall time of each step
    std::vector<Vec3> positions = {}; ///< [m] at the end
    double iterations = 0.0;          ///< [-] linear solver iterations per step; for Bullet, its matrix products
    int unsolved = 0;                 ///< steps whose solver stopped at its iteration limit
};

/// Throws an Error if there is no such mesh.
Problem hangingBunny(int tets);

/// The same bunny made to come to rest: damped, in steps of 20 ms. Its rest shape depends on neither.
Problem restingBunny(const Problem& hanging);

/// [kg] A quarter of each tetrahedron's mass for each of its nodes; 0 for a pinned node.
std::vector<double> lumpedMasses(const Problem& problem);

/// |x - exact| / |exact - start| over all nodes; not finite if the run blew up.
double relativeError(const std::vector<Vec3>& x, const std::vector<Vec3>& exact, const Problem& problem);

} // namespace filasofia::peers
