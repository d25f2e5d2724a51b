#pragma once

#include "filasofia/math/mat3.h"

#include <array>
#include <limits>

/// A linear tetrahedron: what every elastic law (law.h) needs of it.
namespace filasofia::engine {

/// The constants of an element. Only an edit of the mesh or of its material changes them.
struct FemElement {
    std::array<int, 4> nodes{};
    std::array<Vec3, 4> gradients{}; ///< [1/m] gradients of the shape functions at rest; they sum to zero
    double volume = 0.0;             ///< [m^3] at rest
    double youngModulus = 0.0;       ///< [Pa]
    double poissonRatio = 0.0;       ///< [-]
    Mat3 plastic = Mat3::identity(); ///< [-] F_p: the shape at rest relative to that of the mesh, of the same volume
    double restScale = 1.0;          ///< [-] lengths at rest, relative to those of the mesh
    double density = 0.0;            ///< [kg/m^3] of the mesh at rest
    double tearingThreshold = std::numeric_limits<double>::infinity(); ///< [Pa]
    double yieldStress = std::numeric_limits<double>::infinity();      ///< [Pa]
    int tetrahedron = 0; ///< of the Def's mesh: the element itself, or the one from which cuts have made it
};

/// Lame's parameters.
struct Lame {
    double mu = 0.0;     ///< [Pa]
    double lambda = 0.0; ///< [Pa]
};

constexpr Lame lame(double youngModulus, double poissonRatio)
{
    return {youngModulus / (2.0 * (1.0 + poissonRatio)),
            youngModulus * poissonRatio / ((1.0 + poissonRatio) * (1.0 - 2.0 * poissonRatio))};
}
constexpr Lame lameOf(const FemElement& element) { return lame(element.youngModulus, element.poissonRatio); }

/// The stiffness of Hooke's law between two nodes with shape gradients gi and gj [Pa/m^2], to be multiplied by the
/// volume.
constexpr Mat3 hookeBlock(Lame material, Vec3 gi, Vec3 gj)
{
    return material.lambda * outer(gi, gj) + material.mu * outer(gj, gi) + material.mu * dot(gi, gj) * Mat3::identity();
}

using Corners = std::array<Vec3, 4>; ///< one vector per node of a tetrahedron

/// The gradients of the four shape functions of a tetrahedron of positive volume.
Corners shapeGradients(const Corners& rest);

/// sum x_i g_i^T: the deformation gradient for positions, the velocity gradient for velocities.
Mat3 gradient(const FemElement& element, const Corners& x);

/// [N] V P g_i, the internal forces of a first Piola-Kirchhoff stress P [Pa]. The element pulls at its nodes with their
/// opposite.
Corners internalForces(const FemElement& element, const Mat3& stress);

/// [-] A tangent leaves out the geometric stiffness of tension up to this growth of the volume. An element that turns
/// by w in a step grows by w^2. If it is nearly incompressible, that looks like tension, and the stiffness would brake
/// the turn.
constexpr double kTense = 0.1;

/// A deformation gradient and the rotation nearest to it.
struct Deformation {
    Mat3 f;
    Mat3 rotation;
};

} // namespace filasofia::engine
