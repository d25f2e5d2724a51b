#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/math/pose.h"

#include <limits>

namespace filasofia::physics {

/// Where an instrument grips: in front of its pivot, at the inner faces of its jaws. Whatever touches its shaft, the
/// backs of its jaws or what lies behind the pivot is not in its mouth.
struct Mouth {
    int element = 0;                 ///< [-], in [0, elements of the body): in whose coordinates the rest is
    Vec3 pivot = {};                 ///< [m], where the mouth begins
    Vec3 forward = {0.0, 0.0, -1.0}; ///< [-], any length > 0: from the pivot to the tips
    /// [m], in (0, inf], from the pivot to the tips
    double length = std::numeric_limits<double>::infinity();
    /// [-], where the first jaw opens to, at right angles to the plane between the jaws. A contact counts if it pushes
    /// the jaw on its side open; zeros: every one in front of the pivot counts
    Vec3 opens = {};
    friend bool operator==(const Mouth&, const Mouth&) = default;
};

constexpr auto fields(const Mouth*)
{
    using T = Mouth;
    return describe("Mouth",
                    field("element", &T::element, "-", nonNegative(), "element in whose coordinates the rest is"),
                    field("pivot", &T::pivot, "m", finite(), "where the mouth begins"),
                    field("forward", &T::forward, "-", finite(), "from the pivot to the tips"),
                    field("length", &T::length, "m", positiveOrInfinite(), "from the pivot to the tips"),
                    field("opens", &T::opens, "-", finite(),
                          "where the first jaw opens to; zeros: whatever is in front of the pivot counts"));
}

/// [m], by which a jaw reaches over the plane between the jaws, where that faces it.
inline constexpr double kTooth = 0.3e-3;

/// Whether a contact is in the mouth, whose element has this pose. `point` [m] is where it is, and the unit vector
/// `push` the direction in which it pushes on the instrument.
inline bool isInMouth(const Mouth& mouth, const Pose& element, Vec3 point, Vec3 push)
{
    const Pose toElement = inverse(element);
    const Vec3 from = transform(toElement, point) - mouth.pivot;
    const double ahead = dot(from, normalized(mouth.forward));
    if (!(ahead > 0.0 && ahead <= mouth.length)) return false;
    if (mouth.opens == Vec3{}) return true;
    const Vec3 opens = normalized(mouth.opens);
    const double opening = dot(rotate(toElement.orientation, push), opens);
    return opening * dot(from, opens) > -kTooth * opening * opening; // teeth push obliquely the less they reach over
}

} // namespace filasofia::physics
