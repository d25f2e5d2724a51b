#pragma once

#include "filasofia/math/pose.h"
#include "filasofia/physics/attachment_def.h"
#include "filasofia/physics/node_def.h"

#include <optional>
#include <string>
#include <vector>

namespace filasofia::physics {

/// How a rod collides: its surface is a tube around the centre line.
struct RodCollision {
    /// [m], >= 0; contacts are found where surfaces are nearer than the sum of both bodies' proximities. Not given: the
    /// radius
    std::optional<double> proximity = {};
    int group = 0;    ///< only models of the same group collide
    bool self = true; ///< whether the rod collides with itself
};

/// A body that is long, thin and round, such as a thread, a catheter or a guide wire. It resists stretching, bending
/// and twisting; its nodes lie along its centre line, from end to end, or around a ring.
struct RodBodyDef {
    std::string name = "rod";
    /// [m], at least two: the corners of the centre line at the start, from one end to the other
    std::vector<Vec3> points = {};
    /// the last point is joined to the first: a ring, which is not given its first point again at the end
    bool closed = false;
    /// [m], > 0, shorter than the line: nodes are placed along it, about this far apart. Not given: its corners are the
    /// nodes. A rod has at least three nodes, a ring eight, and at most 100,000
    std::optional<double> spacing = {};
    Pose pose = {};            ///< from the points' coordinates to the world
    double radius = 0.15e-3;   ///< [m], > 0
    double youngModulus = 1e9; ///< [Pa], > 0
    double poissonRatio = 0.4; ///< [-], in [0, 0.5]; the shear modulus follows from it
    double density = 1000.0;   ///< [kg/m^3], >= kLeastDensity
    bool straight = true;      ///< at rest it is straight; otherwise, it is at rest as its points lie
    /// [rad] by how much it is twisted at the start, evenly from its first edge to its last; a ring is twisted by this
    /// before its ends are joined
    double twist = 0.0;
    /// [-], in (0, inf], strain of the outermost fibre beyond which bending is plastic: what it is bent by more, it
    /// keeps. Infinite: it never yields. Steel yields at 0.002 to 0.005
    double yieldStrain = kNever;
    double hardening = 0.0; ///< [-], in [0, 1): stiffness of bending beyond yield over that before
    Rayleigh rayleigh = {}; ///< Rayleigh damping
    Vec3 velocity = {};     ///< [m/s], initial, of all nodes that are not pinned
    bool gravity = true;    ///< whether gravity acts on it
    /// attachments of its nodes. An edge whose two nodes are pinned, such as the first one, does not turn about itself
    /// either: that clamps a rod
    std::vector<AttachmentDef> attachments = {};
    std::vector<NodalForce> forces = {};        ///< until changed by a command
    std::optional<RodCollision> collision = {}; ///< none: it collides with nothing
    /// Whether blades may cut it and tension may tear it. Blades are rigid bodies with a collision model that has
    /// `cutting` set
    bool dynamicTopology = false;
    double breakForce = kNever; ///< [N], in (0, inf]: it tears where its tension exceeds this; needs dynamicTopology
    bool needle = false;        ///< its first node is a sharp tip, which pierces tissue that has a PunctureDef
    double friction = 0.3; ///< [-], >= 0, Coulomb's mu; a pair of bodies uses the square root of the product of both
};

constexpr auto fields(const RodCollision*)
{
    using T = RodCollision;
    return describe("RodCollision",
                    field("proximity", &T::proximity, "m", nonNegative(),
                          "contacts are found nearer than this, plus the other body's; none: the radius"),
                    field("group", &T::group, "only models of the same group collide"),
                    field("self", &T::self, "whether it collides with itself"));
}
constexpr auto fields(const RodBodyDef*)
{
    using T = RodBodyDef;
    return describe(
        "RodBodyDef", field("name", &T::name, "its name in errors and reports"),
        field("points", &T::points, "m", finite(), "corners of the centre line, from end to end"),
        field("closed", &T::closed, "a ring: the last point is joined to the first"),
        field("spacing", &T::spacing, "m", positive(), "distance of nodes along the line; none: its corners are nodes"),
        field("pose", &T::pose, "from the points' coordinates to the world"),
        field("radius", &T::radius, "m", positive(), "radius of the cross-section"),
        field("youngModulus", &T::youngModulus, "Pa", positive(), "stiffness against stretching and bending"),
        field("poissonRatio", &T::poissonRatio, "-", closed(0.0, 0.5), "for the stiffness against twisting"),
        field("density", &T::density, "kg/m^3", positive(), "mass per volume"),
        field("straight", &T::straight, "straight at rest; otherwise at rest as its points lie"),
        field("twist", &T::twist, "rad", finite(),
              "twist at the start, from the first edge to the last, or around a ring"),
        field("yieldStrain", &T::yieldStrain, "-", positiveOrInfinite(), "strain of the outermost fibre that stays"),
        field("hardening", &T::hardening, "-", closedOpen(0.0, 1.0), "stiffness of bending beyond yield over before"),
        field("rayleigh", &T::rayleigh, "Rayleigh damping"),
        field("velocity", &T::velocity, "m/s", finite(), "initial velocity of all nodes"),
        field("gravity", &T::gravity, "whether gravity acts on it"),
        field("attachments", &T::attachments, "attachments of its nodes"),
        field("forces", &T::forces, "prescribed nodal forces"),
        field("collision", &T::collision, "how it collides; none: with nothing"),
        field("dynamicTopology", &T::dynamicTopology, "whether it may be cut and may tear"),
        field("breakForce", &T::breakForce, "N", positiveOrInfinite(), "tension beyond which it tears"),
        field("needle", &T::needle, "its first node is a sharp tip"),
        field("friction", &T::friction, "-", within(nonNegative(), kLargestFriction),
              "friction coefficient mu of Coulomb's law"));
}

/// The nodes of a rod at the start, in world coordinates. Throws an Error naming the rod if its points are none of a
/// rod.
std::vector<Vec3> centreLine(const RodBodyDef& def);

} // namespace filasofia::physics
