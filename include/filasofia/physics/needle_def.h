#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/math/vec3.h"

#include <optional>
#include <vector>

namespace filasofia::physics {

/// The needle of a rigid body: a sharp line that pierces tissue which has a PunctureDef. Outside tissue, only the
/// body's collision models touch anything. A rod whose end is attached to the body follows the needle through its
/// channel.
struct NeedleDef {
    std::vector<Vec3> line = {}; ///< [m], at least two points, from the tip to the tail, in the element's coordinates
    double radius = 0.25e-3;     ///< [m], > 0
    /// [m], > 0, < length of the line, >= 1/500 of it: distance of the points at which tissue holds it
    double spacing = 1e-3;
    int element = 0; ///< [-], >= 0, < number of elements: the one that carries it
};

/// How tissue resists needles (Okamura, Simone and O'Leary 2004): up to the puncture, the surface deforms; then the tip
/// cuts, and the shaft rubs along its length. Nothing is remeshed: the channel is a chain of points in the tissue.
struct PunctureDef {
    double force = 0.5;    ///< [N], > 0, on the tip, along the needle: the surface gives way at this
    double cutting = 0.2;  ///< [N], >= 0, at the tip while it advances in tissue
    double friction = 5.0; ///< [N/m], >= 0, per length of shaft or thread in the tissue, while it slides
    /// [N/m], >= friction, per length, before it slides. None: the same
    std::optional<double> staticFriction = {};
    /// [Pa], > 0: force per length of shaft, per distance by which it leaves its channel; also of its friction before
    /// it slides. None: ten times Young's modulus, which leaves most of the compliance to the tissue. Threads are held
    /// ten times as stiffly across, as they load their channel at its mouths alone
    std::optional<double> stiffness = {};
};

constexpr auto fields(const NeedleDef*)
{
    using T = NeedleDef;
    return describe("NeedleDef", field("line", &T::line, "m", finite(), "its points, from the tip to the tail"),
                    field("radius", &T::radius, "m", positive(), "radius of the shaft"),
                    field("spacing", &T::spacing, "m", positive(), "distance of the points at which tissue holds it"),
                    field("element", &T::element, "the element that carries it"));
}
constexpr auto fields(const PunctureDef*)
{
    using T = PunctureDef;
    return describe(
        "PunctureDef", field("force", &T::force, "N", positive(), "force along a needle that breaks the surface"),
        field("cutting", &T::cutting, "N", nonNegative(), "force at the tip while it advances"),
        field("friction", &T::friction, "N/m", nonNegative(), "friction per length while it slides"),
        field("staticFriction", &T::staticFriction, "N/m", nonNegative(), "before it slides; none: the same"),
        field("stiffness", &T::stiffness, "Pa", positive(),
              "force per length and distance from the channel; none: ten times Young's modulus; threads: ten times as "
              "stiff"));
}

} // namespace filasofia::physics
