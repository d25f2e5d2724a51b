#pragma once

#include "filasofia/math/pose.h"

#include <vector>

/// Where hand and needle driver are while they tie a throw.
///
/// The driver comes over the wound from the side of the long strand, and points to the side of the tail, and down. The
/// long strand rises from its base in front of the shaft; the hand goes over the shaft, behind it, below it and to the
/// front again. Then the jaws take the tail, draw it back through the loops, and hand and driver part, each to the
/// other side. So each throw is the mirror image of that before: a square knot.
namespace filasofia::prefab {

/// One throw: what is known of the strands before it, and the places that follow from that.
struct TiePlan {
    Vec3 across = {}, up = {}, front = {}; ///< [-] unit vectors, each at right angles to the others
    double side = 1.0;                     ///< [-] 1 or -1, where the long strand is along `across`
    double mouth = 0.0;                    ///< [m] from the driver's pivot to where its jaws hold
    Vec3 strandBase = {}, tailBase = {};   ///< [m] where the strands leave the tissue
    double strand = 0.0, tail = 0.0;       ///< [m] their lengths from there to what is held of them

    [[nodiscard]] Vec3 direction(double toStrand, double upwards, double forwards) const; ///< [-] a unit vector
    [[nodiscard]] Vec3 along() const;     ///< [-] where the driver points
    [[nodiscard]] Vec3 over() const;      ///< [-] at right angles to it, upwards
    [[nodiscard]] Vec3 aside() const;     ///< [m] where the end of the tail is out of the hand's way
    [[nodiscard]] Vec3 tailwards() const; ///< [-] from there to its base
    [[nodiscard]] Vec3 inwards() const;   ///< [-] from the end of the tail inwards, as the driver takes it
    [[nodiscard]] Vec3 shown() const; ///< [m] where the driver takes it: before the loops, which are over their base
    [[nodiscard]] double between() const;   ///< [m] from the loops to the tail's base, along the shaft
    [[nodiscard]] double leastTail() const; ///< [m] a shorter one does not suffice for that way
    [[nodiscard]] double high() const; ///< [m] from the long strand's base to the shaft while it is wound around it
    [[nodiscard]] Vec3 loops(const Pose& driver) const; ///< [m] on the shaft's axis, beside the long strand's base
    /// [-] from the axis to the hand, after so large an angle [rad].
    [[nodiscard]] Vec3 around(double angle) const;

    [[nodiscard]] Pose holding(Vec3 at) const;  ///< the driver's, if its mouth is here
    [[nodiscard]] Pose above(Vec3 place) const; ///< over the place, pointing down: where it turns to the other side
    [[nodiscard]] Pose coming() const;          ///< whence it comes over the wound, along its shaft
    [[nodiscard]] Pose winding() const;         ///< where it waits for the loops
    [[nodiscard]] Pose taking() const { return holding(shown()); }
    [[nodiscard]] Pose drawn() const; ///< where it is out of the loops
};

} // namespace filasofia::prefab
