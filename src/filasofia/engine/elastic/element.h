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
/// [-] The largest Poisson's ratio with which an element resists a change of its volume by itself: with a larger one,
/// linear tetrahedra lock. Beyond it the nodes bear the volume (body/nodal_volume.h), and the element's own law has
/// kSharedPoisson. The rest of the bulk modulus keeps single elements from changing their volumes against each other.
/// Cook's membrane of 6,144 elements at 0.4999 deflects 0.75 of the reference if that is 0.45 and 0.86 if it is 0.3; at
/// a Poisson's ratio of 0.3 it is 0.89.
inline constexpr double kElementPoisson = 0.45, kSharedPoisson = 0.3;

/// The constants with which an element's own law is computed.
constexpr Lame lameOf(const FemElement& element)
{
    const Lame all = lame(element.youngModulus, element.poissonRatio);
    if (element.poissonRatio <= kElementPoisson) return all;
    return {all.mu, all.mu * 2.0 * kSharedPoisson / (1.0 - 2.0 * kSharedPoisson)};
}
/// [Pa] The rest of lambda, with which the nodes of an element resist a change of their volume.
constexpr double nodalBulk(const FemElement& element)
{
    if (element.poissonRatio <= kElementPoisson) return 0.0;
    return lame(element.youngModulus, element.poissonRatio).lambda - lameOf(element).lambda;
}

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

/// d(det F)/dF.
constexpr Mat3 cofactor(const Mat3& f) { return {{cross(f[1], f[2]), cross(f[2], f[0]), cross(f[0], f[1])}}; }

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
