#pragma once

#include "filasofia/math/mat3.h"

#include <array>

/// A triangle of a sheet that resists bending: Kirchhoff's plate on the angles theta_i between a triangle and its up to
/// three neighbours (discrete shells, Grinspun et al. 2003, with the shape operator of Grinspun, Gingold, Reisman and
/// Zorin 2006).
///
///     K = sum over edges of theta_i l_i / (2 A) n_i n_i^T            the curvature of the triangle
///     W = A D/2 ((1 - nu) |K - K_rest|^2 + nu tr(K - K_rest)^2)      D = E t^3 / (12 (1 - nu^2))
///
///     l_i  length of the edge     n_i  unit vector across it, in the triangle     A  area, all at rest
///
/// With a stiffness matrix S per triangle this is W = 1/2 (theta - theta_rest) . S (theta - theta_rest). An edge
/// without a neighbour bears no moment: its angle is the one that makes W least. Half of an angle belongs to each side:
/// that is exact where both triangles are mirror images through the middle of the edge, as in a regular mesh.
namespace filasofia::engine {

/// Per node: the triangle's own three, then the one across the edge opposite to each of them.
using BendingCorners = std::array<Vec3, 6>;

/// The constants of a triangle and its neighbours.
struct BendingElement {
    std::array<int, 6> nodes{};         ///< an edge without a neighbour repeats its opposite corner
    std::array<double, 3> restAngles{}; ///< [rad] theta at rest, edge i opposite to corner i; 0 without a neighbour
    std::array<double, 6> shape{};      ///< [-] 00 01 02 11 12 22: S / D
    double rigidity = 0.0;              ///< [N m] D
    double leastArea = 0.0;             ///< [m^4] squared doubled area below which a triangle counts as this large
};

/// The edges of a triangle that have a neighbour.
using Hinged = std::array<bool, 3>;

/// A triangle with these corners at rest, without a rigidity.
BendingElement bendingOn(const std::array<int, 6>& nodes, const Hinged& hinged, const BendingCorners& rest,
                         double poissonRatio);

/// The angles of a triangle with its neighbours.
struct BendingAngles {
    std::array<double, 3> theta{};                  ///< [rad] in [-pi, pi], positive where the sheet is convex
    std::array<std::array<Vec3, 4>, 3> gradients{}; ///< [rad/m] by the nodes of hingeNodes()
};
BendingAngles bendingAngles(const BendingElement& element, const BendingCorners& x);

/// The places in BendingCorners that the angle at edge i depends on: the opposite corner, the edge's ends, the corner
/// across.
constexpr std::array<int, 4> hingeNodes(int edge) { return {edge, (edge + 1) % 3, (edge + 2) % 3, 3 + edge}; }

/// [J]
double bendingEnergy(const BendingElement& element, const BendingCorners& x);

/// [N] forces on the nodes: minus the gradient of the energy.
BendingCorners bendingForces(const BendingElement& element, const BendingCorners& x);

/// The tangent K = sum of S_ij grad theta_i grad theta_j^T, without the curvature of theta itself: positive
/// semi-definite, and exact at rest.
struct BendingTangent {
    std::array<std::array<Vec3, 6>, 3> gradients{}; ///< [rad/m] by node
    std::array<double, 6> stiffness{};              ///< [N m] S
};
BendingTangent bendingTangent(const BendingElement& element, const BendingCorners& x);

/// [N/m] The block of nodes i and j.
Mat3 stiffnessBlock(const BendingTangent& tangent, int i, int j);

/// [N] K p
BendingCorners stiffnessTimes(const BendingTangent& tangent, const BendingCorners& p);

/// [N m] D of a plate.
constexpr double plateRigidity(double youngModulus, double poissonRatio, double thickness)
{
    return youngModulus * thickness * thickness * thickness / (12.0 * (1.0 - poissonRatio * poissonRatio));
}

} // namespace filasofia::engine
