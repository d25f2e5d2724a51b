#pragma once

#include "filasofia/math/mat3.h"

#include <array>

/// Bending and twisting of a rod at one of its inner nodes: discrete elastic rods (Bergou, Wardetzky, Robinson, Audoly
/// and Grinspun 2008; Bergou, Audoly, Vouga, Wardetzky and Grinspun 2010) with a round cross-section. What a rod
/// resists stretching with is a spring along every edge.
///
///     kb = 2 e x f / (|e| |f| + e . f)      the curvature, as an angle: |kb| = 2 tan(angle / 2)
///     W  = B / (4 l) sum over both edges j of |kb - k_j|^2 + T / (2 l) m^2
///
///     e, f  the edges before and after the node     l     [m] length of rod that belongs to the node
///     k_j   the curvature at rest, which turns with the material of edge j
///     m     [rad] the twist: the angle between the materials of e and f
///     B, T  [N m^2] E pi r^4 / 4 and G pi r^4 / 2
///
/// The material of an edge is a director: a unit vector across the edge. Its angle about the edge is an unknown of its
/// own. As the nodes move, directors follow the edges without turning about them (time-parallel transport).
namespace filasofia::engine {

/// [-] A curvature, as kb is one, along the director of each of both edges, and along their third axes, edge x
/// director.
using RodCurvature = std::array<std::array<double, 2>, 2>;

/// The constants of an inner node.
struct RodJoint {
    double bend = 0.0;   ///< [N m] B / l
    double twist = 0.0;  ///< [N m] T / l
    RodCurvature rest{}; ///< [-] at rest
};

/// The state around an inner node.
struct RodPlace {
    std::array<Vec3, 3> x{};         ///< [m] the node before, the node, the node after
    std::array<Vec3, 2> directors{}; ///< on both edges
    double twist = 0.0;              ///< [rad] m, any number of turns
};

/// A value per unknown: the node before (3), the angle of the first edge, the node (3), the angle of the second edge,
/// the node after (3). The last entry is unused.
using RodVector = std::array<double, 12>;

/// A term of the tangent, stiffness * gradient gradient^T.
struct RodTerm {
    double stiffness = 0.0; ///< [N m], >= 0
    RodVector gradient{};   ///< [1/m], for angles [-]
};
using RodTangent = std::array<RodTerm, 6>;

/// kb, for edges of any length > 0. Finite in every state: beyond 168 degrees it falls again.
Vec3 rodCurvature(Vec3 e, Vec3 f);

/// [J]
double rodEnergy(const RodJoint& joint, const RodPlace& at);

/// What a joint answers with.
struct RodResponse {
    /// [N], [N m] Forces and torques: minus the gradient of the energy. Beyond 168 degrees the force of twisting is
    /// bounded, and less than that.
    RodVector forces{};
    /// A sum of terms: positive semi-definite, exact at rest and, for bending in one plane, exact everywhere. Left out
    /// are the terms by which moments turn with the rod, as far as they are negative or across that plane.
    RodTangent tangent{};
};
RodResponse rodResponse(const RodJoint& joint, const RodPlace& at);

/// A director carried along as the direction of its edge turns from one unit vector to another: by the smallest
/// rotation between the two.
Vec3 transported(Vec3 director, Vec3 from, Vec3 to);

/// [rad] in [-pi, pi]: by how much the second director is turned about its edge against the first one. The directions
/// of both edges are unit vectors.
double rodTwist(const std::array<Vec3, 2>& directors, const std::array<Vec3, 2>& directions);

/// [-] The curvature kb in the material of both edges.
RodCurvature curvatureInMaterial(const RodPlace& at);

/// How bending turns plastic: a bilinear law of moment and curvature, with Prager's linear kinematic hardening.
struct RodYield {
    double curvature = 0.0; ///< [-] by which kb differs from that at rest when it yields; may be infinite
    double hardening = 0.0; ///< [-], >= 0, H / B: the yield surface follows what has flowed by H times that
};

/// The plastic curvature after a step that ended at `now`, by radial return (Simo and Hughes 1998, section 1.2): in the
/// material of each edge, |kb - rest - plastic - (H / B) plastic| <= yield. What is within stays bit for bit.
RodCurvature plasticCurvature(const RodYield& yield, const RodCurvature& rest, const RodCurvature& now,
                              RodCurvature plastic);

} // namespace filasofia::engine
