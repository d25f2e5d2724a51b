#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/math/pose.h"

#include <limits>
#include <string_view>

/// Where a shaft goes through the abdominal wall, and how it may move there.
namespace filasofia::prefab {

/// The pose of a shaft in its trocar.
struct TrocarPose {
    double yaw = 0.0;       ///< [rad], turns the tip to the right, seen along the trocar's axis with `up` above
    double pitch = 0.0;     ///< [rad], turns the tip towards `up`
    double insertion = 0.0; ///< [m], distance of the pivot of the jaws, or of a scope's tip, beyond the fulcrum
    double roll = 0.0;      ///< [rad], about the shaft, counter-clockwise seen from the handle

    friend constexpr bool operator==(const TrocarPose&, const TrocarPose&) = default;
};
constexpr auto fields(const TrocarPose*)
{
    using T = TrocarPose;
    return describe("TrocarPose", field("yaw", &T::yaw, "rad", finite(), "turns the tip to the right"),
                    field("pitch", &T::pitch, "rad", finite(), "turns the tip upwards"),
                    field("insertion", &T::insertion, "m", finite(), "distance of pivot or tip beyond the fulcrum"),
                    field("roll", &T::roll, "rad", finite(), "about the shaft"));
}

/// The wall holds the shaft at the fulcrum like a spring with a damper, sideways; the seal of the trocar rubs along it.
///
/// Seals were measured to rub with 0.25 to 3 N (van den Dobbelsteen, Schooleman and Dankelman 2007, Surg Endosc
/// 21:1338). The stiffnesses of the wall are chosen, not measured.
struct TrocarDef {
    Vec3 fulcrum = {};            ///< [m], where the wall holds the shaft while nothing pushes it sideways
    Vec3 axis = {0.0, 0.0, -1.0}; ///< [-], any length > 0, into the body: the shaft's direction at yaw and pitch 0
    Vec3 up = {0.0, 1.0, 0.0};    ///< [-], not parallel to the axis: the direction of pitch
    double mostTilt = 1.0;        ///< [rad], in (0, 1.5], largest angle between shaft and axis
    double leastInsertion = 0.0;  ///< [m]
    double mostInsertion = 0.25;  ///< [m], >= leastInsertion, < the shaft's length
    /// [N/m], in (0, inf], sideways at the fulcrum; inf: it stays where it is
    double wallStiffness = 2000.0;
    double wallDamping = 200.0; ///< [N s/m], > 0, the same: the wall yields with the time constant damping / stiffness
    double tiltStiffness = 0.0; ///< [N m/rad], >= 0, torque that turns the shaft back to the axis
    double friction = 0.5;      ///< [N], >= 0, of the seal, against insertion and withdrawal
};
constexpr auto fields(const TrocarDef*)
{
    using T = TrocarDef;
    return describe(
        "TrocarDef", field("fulcrum", &T::fulcrum, "m", finite(), "where the wall holds the shaft"),
        field("axis", &T::axis, "-", finite(), "direction of the shaft at yaw and pitch 0, into the body"),
        field("up", &T::up, "-", finite(), "direction of pitch"),
        field("mostTilt", &T::mostTilt, "rad", openClosed(0, 1.5), "largest angle between shaft and axis"),
        field("leastInsertion", &T::leastInsertion, "m", finite(), "lower limit"),
        field("mostInsertion", &T::mostInsertion, "m", finite(), "upper limit"),
        field("wallStiffness", &T::wallStiffness, "N/m", positiveOrInfinite(), "sideways at the fulcrum"),
        field("wallDamping", &T::wallDamping, "N s/m", positive(), "sideways at the fulcrum"),
        field("tiltStiffness", &T::tiltStiffness, "N m/rad", nonNegative(), "turns the shaft back to the axis"),
        field("friction", &T::friction, "N", nonNegative(), "of the seal, along the shaft"));
}

/// How the shaft of a trocar is held outside.
struct TrocarHandleDef {
    double length = 0.36; ///< [m], > 0, from the pivot, or a scope's tip, to where the hand holds it
    /// [N], > 0, the hand does not push or pull against a larger force.
    double strength = std::numeric_limits<double>::infinity();
    bool haptic = false; ///< a haptic device moves it: see handle()
};
constexpr auto fields(const TrocarHandleDef*)
{
    using T = TrocarHandleDef;
    return describe("TrocarHandleDef", field("length", &T::length, "m", positive(), "from the pivot to the hand"),
                    field("strength", &T::strength, "N", positiveOrInfinite(), "the hand yields to a larger force"),
                    field("haptic", &T::haptic, "whether a haptic device moves it"));
}

/// What a hand at the handle feels, and where the shaft is.
struct TrocarReport {
    TrocarPose pose = {}; ///< that the hand has given, as far as strength and speed let it
    Pose pivot = {};      ///< the jaws' pivot or a scope's tip, in the world
    Vec3 handle = {};     ///< [m], where the hand holds the shaft, in the world
    Vec3 shift = {};      ///< [m], how far the wall has yielded at the fulcrum
    Vec3 force = {};      ///< [N], on the hand: tissue by the lever, wall and seal
    double torque = 0.0;  ///< [N m], on the hand, about the shaft's direction
    Vec3 wall = {};       ///< [N], from the wall on the shaft, sideways
};

/// The pivot or tip of a shaft in this pose, with its roll, while the wall does not yield. It looks along -Z.
Pose pivotOf(const TrocarDef& trocar, const TrocarPose& pose);
/// The pose with this roll that brings a point, in the pivot's coordinates, to a target in the world [m]; nothing is
/// limited. Error if the pivot would be in the fulcrum.
TrocarPose poseAt(const TrocarDef& trocar, Vec3 target, double roll = 0.0, Vec3 point = {});
/// [rad] in [-pi/2, pi/2], the roll at which jaws that open along the pivot's Y open as nearly along `across` as they
/// can, with the pivot at a place in the world.
double rollAcross(const TrocarDef& trocar, Vec3 pivot, Vec3 across);
/// The nearest pose within the limits.
TrocarPose withinLimits(const TrocarDef& trocar, TrocarPose pose);
/// Throws an Error that names `object`, the field and the limit, if a pose is outside the limits or not finite.
void checkLimits(const TrocarDef& trocar, const TrocarPose& pose, std::string_view object);
/// The part from a to b, linear in each number.
TrocarPose between(const TrocarPose& a, const TrocarPose& b, double part);

} // namespace filasofia::prefab
